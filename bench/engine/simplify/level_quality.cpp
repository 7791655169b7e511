// What levels of detail are worth: topology, distance to M0 both ways, rims, drift of the volume, intersecting pairs
// and CPU time; other libraries beside them at equal counts. A table on the terminal, and everything as JSON.
//
// usage: level_quality [options] SURFACE...      surfaces: see bench_mesh.h

#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/engine/simplify/bench_mesh.h"
#include "bench/engine/simplify/level_measures.h"
#include "bench/engine/simplify/peers.h"
#include "engine/simplify/build_lods.h"

namespace geosis {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::vector<std::string> surfaces;
  std::vector<double> ratios = {0.25, 0.05, 0.01};
  std::vector<double> peer_ratios = {0.25, 0.05, 0.01};
  std::vector<std::string> peers;  // names' beginnings; none = all
  bool default_caps = false, variants = false, no_peers = false;
  std::string out, commit;
};

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

std::string first_line_of(const std::string& path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(key)) return line;
  }
  return {};
}

Json to_json(const DistanceSpread& spread) {
  return {{"mean", spread.mean}, {"p99", spread.p99}, {"max", spread.max}};
}

Json to_json(const TwoWays& ways) {
  return {{"from_m0", to_json(ways.away)}, {"to_m0", to_json(ways.back)}};
}

Json to_json(const IntersectingPairs& pairs) {
  return {{"within_a_sheet", pairs.within_a_sheet},
          {"between_sheets", pairs.between_sheets},
          {"between_components", pairs.between_components}};
}

Json to_json(const LevelMeasures& measures) {
  Json json = {{"triangles", measures.triangles},
               {"components", measures.components},
               {"euler", measures.euler},
               {"genus", measures.genus},
               {"boundary_loops", measures.boundary_loops},
               {"topology", measures.topology},
               {"distance_voxels", to_json(measures.distance)},
               {"volume_drift", measures.volume_drift}};
  if (measures.rim) json["rim_distance_voxels"] = to_json(*measures.rim);
  if (measures.pairs) json["intersecting_pairs"] = to_json(*measures.pairs);
  return json;
}

const char* name_of(StoppedBy stopped) {
  switch (stopped) {
    case StoppedBy::none:
      return "";
    case StoppedBy::floor:
      return "floor";
    case StoppedBy::error_cap:
      return "error_cap";
  }
  return "";
}

/// One surface: its rows are printed as they come and kept for the JSON.
class Report {
 public:
  explicit Report(const BenchMesh& mesh) : mesh_(mesh), against_(mesh) {
    const LevelMeasures m0 = against_.measure(mesh.m0, {}, true);
    json_ = {{"surface", mesh.name}, {"data_sha256", mesh.data_sha256}, {"m0", to_json(m0)}, {"levels", Json::array()}};
    std::printf("\n%s: euler %lld, genus %lld, %lld components, %lld loops\n", mesh.name.c_str(),
                static_cast<long long>(m0.euler), static_cast<long long>(m0.genus),
                static_cast<long long>(m0.components), static_cast<long long>(m0.boundary_loops));
    std::printf("  %-24s %9s %7s %7s %7s %6s %6s %6s %6s %8s %15s %17s  %s\n", "", "triangles", "cpu s", "from M0",
                "to M0", "p99", "p99", "max", "max", "drift %", "pairs in/sh/co", "rim mean p99 max", "topology");
    print("M0", m0, 0);
  }

  /// A chain of levels by ratio; the CPU time is the whole chain's.
  std::vector<std::size_t> add_levels(const std::string& name, const BuildLodsOptions& options) {
    NoProgress progress;
    const double start = cpu_seconds();
    const auto lods = build_lods(mesh_.m0, options, progress);
    const double cpu = cpu_seconds() - start;
    if (!lods) {
      std::printf("  %s: %s\n", name.c_str(), lods.error().message.c_str());
      return {};
    }
    std::vector<std::size_t> counts;
    for (std::size_t k = 0; k < lods->levels.size(); ++k) {
      const LodLevel& level = lods->levels[k];
      const Json row = {
          {"by", name}, {"asked_ratio", *options.levels[k].ratio}, {"stopped_by", name_of(level.stopped_by)}};
      add(row, against_.measure(level.mesh, level.origin, true), cpu);
      counts.push_back(level.mesh.triangles.size());
    }
    return counts;
  }

  void add_peer(const Peer& peer, std::size_t triangles) {
    const double start = cpu_seconds();
    const IndexedMesh level = peer.simplify(mesh_.m0, triangles);
    const double cpu = cpu_seconds() - start;
    add({{"by", peer.name}, {"asked_triangles", triangles}}, against_.measure(level, {}, peer.on_lattice), cpu);
  }

  const Json& json() const { return json_; }

 private:
  void add(Json row, const LevelMeasures& measures, double cpu) {
    std::string name = row["by"];
    if (row.contains("stopped_by") && row["stopped_by"] != "")
      name += " (" + row["stopped_by"].get<std::string>() + ")";
    print(name, measures, cpu);
    row["cpu_seconds"] = cpu;
    row.update(to_json(measures));
    json_["levels"].push_back(row);
  }

  static void print(const std::string& name, const LevelMeasures& m, double cpu) {
    const auto& [away, back] = m.distance;
    std::string pairs = "-", rim = "-";
    if (m.pairs) {
      pairs = std::to_string(m.pairs->within_a_sheet) + "/" + std::to_string(m.pairs->between_sheets) + "/" +
              std::to_string(m.pairs->between_components);
    }
    if (m.rim) {
      char text[64];
      std::snprintf(text, sizeof text, "%.3f %.2f %.2f", std::max(m.rim->away.mean, m.rim->back.mean),
                    std::max(m.rim->away.p99, m.rim->back.p99), std::max(m.rim->away.max, m.rim->back.max));
      rim = text;
    }
    std::printf("  %-24s %9lld %7.2f %7.4f %7.4f %6.3f %6.3f %6.2f %6.2f %8.3f %15s %17s  %s\n", name.c_str(),
                static_cast<long long>(m.triangles), cpu, away.mean, back.mean, away.p99, back.p99, away.max, back.max,
                100 * m.volume_drift, pairs.c_str(), rim.c_str(), m.topology.c_str());
    std::fflush(stdout);
  }

  const BenchMesh& mesh_;
  MeasuredAgainst against_;
  Json json_;
};

BuildLodsOptions options_for(const Arguments& arguments, Strategy strategy, Placement placement) {
  BuildLodsOptions options{.levels = by_ratio(arguments.ratios), .strategy = strategy, .placement = placement};
  if (arguments.default_caps) return options;
  for (LevelTarget& level : options.levels) level.error_cap = std::numeric_limits<double>::infinity();
  return options;
}

bool is_wanted(const Peer& peer, const Arguments& arguments) {
  if (arguments.no_peers || arguments.peers.empty()) return !arguments.no_peers;
  return std::ranges::any_of(arguments.peers,
                             [&](const std::string& name) { return peer.name.find(name) != std::string::npos; });
}

Json report(const BenchMesh& mesh, const Arguments& arguments) {
  Report report(mesh);
  const auto counts = report.add_levels("greedy", options_for(arguments, Strategy::greedy, Placement::optimal));
  if (arguments.variants) {
    report.add_levels("multiple choice", options_for(arguments, Strategy::multiple_choice, Placement::optimal));
    report.add_levels("greedy, subset", options_for(arguments, Strategy::greedy, Placement::subset));
  }
  for (const Peer& peer : peers()) {
    for (std::size_t k = 0; k < counts.size() && is_wanted(peer, arguments); ++k) {
      if (std::ranges::find(arguments.peer_ratios, arguments.ratios[k]) == arguments.peer_ratios.end()) continue;
      report.add_peer(peer, counts[k]);
    }
  }
  return report.json();
}

int run(const Arguments& arguments) {
  const std::string processor = first_line_of("/proc/cpuinfo", "model name");
  Json document = {{"commit", arguments.commit},
                   {"machine", std::to_string(std::thread::hardware_concurrency()) + " x " +
                                   processor.substr(std::min(processor.size(), processor.find(':') + 2))},
                   {"load_at_start", first_line_of("/proc/loadavg", "")},
                   {"compiler", "g++ " __VERSION__},
                   {"error_caps", arguments.default_caps ? "default" : "none"},
                   {"samples_each_way", 100'000},
                   {"surfaces", Json::array()}};
  for (const std::string& surface : arguments.surfaces) {
    const auto mesh = make_bench_mesh(surface);
    if (!mesh) {
      std::fprintf(stderr, "%s: %s\n", surface.c_str(), mesh.error().message.c_str());
      return 1;
    }
    document["surfaces"].push_back(report(*mesh, arguments));
    if (!arguments.out.empty()) std::ofstream(arguments.out) << document.dump(1) << '\n';  // after each: they take long
  }
  return 0;
}

}  // namespace
}  // namespace geosis

int main(int argc, char** argv) {
  geosis::Arguments arguments;
  CLI::App app("What levels of detail are worth");
  app.add_option("surfaces", arguments.surfaces, "kind:nodes:seed or a file, see bench_mesh.h")->required();
  app.add_option("--ratios", arguments.ratios, "of the levels")->delimiter(',')->capture_default_str();
  app.add_option("--peer-ratios", arguments.peer_ratios, "those at which peers are run")->delimiter(',');
  app.add_option("--peers", arguments.peers, "only those whose names hold one of these")->delimiter(',');
  app.add_flag("--no-peers", arguments.no_peers);
  app.add_flag("--default-caps", arguments.default_caps, "the default error caps instead of none");
  app.add_flag("--variants", arguments.variants, "multiple choice and subset as well");
  app.add_option("--out", arguments.out, "JSON file");
  app.add_option("--commit", arguments.commit, "for the JSON file");
  CLI11_PARSE(app, argc, argv);
  return geosis::run(arguments);
}
