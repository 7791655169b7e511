#include "bench/engine/simplify/bench_mesh.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "engine/base/digest.h"
#include "engine/isosurface/extract.h"
#include "engine/volume/brick_file.h"
#include "engine/volume/formats/import.h"
#include "engine/volume/sample_at.h"
#include "engine/volume/synthetic_survey.h"
#include "tests/engine/simplify/field_mesh.h"

namespace geosis {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kThreads = 2;

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> words(1);
  for (const char c : text) {
    if (c == separator) {
      words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  return words;
}

float number(const std::string& word) {
  if (word == "inf") return kInfinity;
  if (word == "-inf") return -kInfinity;
  return std::strtof(word.c_str(), nullptr);
}

int whole_number(const std::string& word) {
  return std::atoi(word.c_str());
}

/// A specification taken apart.
struct Specification {
  std::string kind;
  std::vector<std::string> numbers;
  std::optional<IsoRange> range;
  bool open = false, holes = false;
};

Specification parse(const std::string& text) {
  Specification parsed;
  for (const std::string& word : split(text, ':')) {
    if (parsed.kind.empty()) {
      parsed.kind = word;
    } else if (word == "open") {
      parsed.open = true;
    } else if (word == "holes") {
      parsed.holes = true;
    } else if (word.starts_with("range=")) {
      const auto ends = split(word.substr(6), ',');
      parsed.range = IsoRange{number(ends.front()), number(ends.back())};
    } else {
      parsed.numbers.push_back(word);
    }
  }
  return parsed;
}

std::string digest_of(const IndexedMesh& mesh) {
  Sha256 sha;
  sha.update(std::as_bytes(std::span(mesh.positions)));
  sha.update(std::as_bytes(std::span(mesh.triangles)));
  return std::move(sha).hex();
}

std::vector<float> survey_samples(const SyntheticSurvey& survey, GridShape shape) {
  std::vector<float> samples(static_cast<std::size_t>(shape.count()), std::nanf(""));
  const auto length = static_cast<std::size_t>(shape.samples);
  for (std::int32_t i = 0; i < shape.inlines; ++i) {
    for (std::int32_t j = 0; j < shape.crosslines; ++j) {
      if (!survey.has_trace(i, j)) continue;
      const auto first = static_cast<std::size_t>(std::int64_t{i} * shape.crosslines + j) * length;
      survey.fill_trace(i, j, std::span(samples).subspan(first, length));
    }
  }
  return samples;
}

/// Which of the two ends each vertex is of.
Result<std::vector<std::uint8_t>> sheets(const IndexedMesh& m0, const BrickedVolume& volume, IsoRange range) {
  if (!std::isfinite(range.low) || !std::isfinite(range.high)) return std::vector<std::uint8_t>();
  NoProgress progress;
  const auto values = sample_at(volume, m0.positions, kThreads, progress);
  if (!values) return values.error();
  std::vector<std::uint8_t> sheet;
  for (const float value : *values) sheet.push_back(std::abs(value - range.low) > std::abs(value - range.high));
  return sheet;
}

Result<BenchMesh> surface_of(const BrickedVolume& volume, const Specification& asked, IsoRange otherwise) {
  const IsoRange range = asked.range.value_or(otherwise);
  NoProgress progress;
  auto m0 =
      extract_body(volume, range, {.cap = !asked.open, .region = whole(volume.shape()), .threads = kThreads}, progress);
  if (!m0) return std::move(m0).error();
  auto sheet = sheets(*m0, volume, range);
  if (!sheet) return std::move(sheet).error();
  return BenchMesh{{}, {}, *std::move(m0), *std::move(sheet)};
}

Result<BenchMesh> survey_surface(const Specification& asked) {
  const bool channel = asked.kind == "channel";
  const auto nodes = whole_number(asked.numbers.at(0));
  const GridShape shape{nodes, nodes, nodes};
  const SyntheticSurvey survey({.shape = shape,
                                .kind = channel ? SurveyKind::channel : SurveyKind::reflectors,
                                .seed = static_cast<std::uint64_t>(whole_number(asked.numbers.at(1))),
                                .polygon = asked.holes,
                                .holes = asked.holes});
  const auto volume = make_bricked_volume(shape, survey_samples(survey, shape));
  return surface_of(*volume, asked, {channel ? 0.55f : 0.2f, kInfinity});
}

BenchMesh rough_gyroid(int nodes) {
  const NodeField smooth = gyroid(20, 0.2), rough = noise(7);
  const std::array<int, 3> shape{nodes, nodes, nodes};
  return {{},
          {},
          mesh_field(shape, closed_on_faces(
                                shape, [&](int i, int j, int k) { return smooth(i, j, k) + 0.1 * rough(i, j, k); })),
          {}};
}

Result<BenchMesh> file_surface(const Specification& asked) {
  auto source = open_file(asked.kind);
  if (!source) return std::move(source).error();
  ImportOptions options;
  if (!asked.numbers.empty()) {
    const auto dims = split(asked.numbers[0], ',');
    options.format = FileFormat::raw;
    options.dims = GridShape{whole_number(dims.at(0)), whole_number(dims.at(1)), whole_number(dims.at(2))};
    options.dtype = asked.kind.ends_with(".f32") ? SampleType::float32 : SampleType::uint8;
    options.order = RawOrder::inline_fastest;
  }
  NoProgress progress;
  const auto imported = import_volume(**source, options, std::nullopt, progress);
  if (!imported) return imported.error();
  auto mesh = surface_of(*imported->samples, asked, {0, kInfinity});
  if (mesh) mesh->data_sha256 = imported->description.digest;
  return mesh;
}

}  // namespace

Result<BenchMesh> make_bench_mesh(const std::string& specification) {
  const Specification asked = parse(specification);
  const bool survey = asked.kind == "channel" || asked.kind == "reflectors";
  const std::size_t numbers = survey ? 2 : asked.kind == "gyroid" ? 1 : asked.numbers.size();
  if (asked.numbers.size() != numbers || numbers > 2) {
    return Error{ErrorCode::invalid_argument, "what surface is " + specification + "? See bench_mesh.h"};
  }
  Result<BenchMesh> mesh = survey                   ? survey_surface(asked)
                           : asked.kind == "gyroid" ? rough_gyroid(whole_number(asked.numbers[0]))
                                                    : file_surface(asked);
  if (!mesh) return mesh;
  mesh->name = specification.substr(specification.rfind('/') + 1);
  if (mesh->data_sha256.empty()) mesh->data_sha256 = digest_of(mesh->m0);
  return mesh;
}

}  // namespace geosis
