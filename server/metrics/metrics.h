#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace geosis::server {

/// Numbers that a Prometheus server collects. Any thread may call any member.
///
///     Metrics metrics({{"geosis_jobs_total", Metrics::Kind::counter, "Jobs that have ended."}});
///     metrics.add("geosis_jobs_total", {{"outcome", "done"}});
class Metrics {
 public:
  enum class Kind { counter, gauge, histogram };
  struct Family {
    std::string name;
    Kind kind;
    std::string help;
  };
  using Labels = std::vector<std::pair<const char*, std::string>>;  ///< of one family always the same, in one order

  explicit Metrics(const std::vector<Family>& families);

  /// Names are of the families given; others are not counted.
  void add(const char* counter, const Labels& labels = {}, double amount = 1);
  void set(const char* gauge_or_counter, const Labels& labels, double value);
  void observe(const char* histogram, const Labels& labels, double seconds);

  /// Prometheus' text exposition, version 0.0.4.
  std::string text() const;

 private:
  struct Series {
    double value = 0;                    ///< the sum, of a histogram
    std::uint64_t count = 0;             ///< of a histogram
    std::vector<std::uint64_t> buckets;  ///< of a histogram, not cumulative
  };
  struct Entry {
    Family family;
    std::map<std::string, Series> series;  ///< by their labels as written
  };

  Series* series_of(const char* name, Kind kind, const Labels& labels);
  static void write_histogram(const std::string& name, const std::string& labels, const Series& series,
                              std::string& text);

  mutable std::mutex mutex_;
  std::map<std::string, Entry, std::less<>> entries_;
};

}  // namespace geosis::server
