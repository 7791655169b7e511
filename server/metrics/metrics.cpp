#include "server/metrics/metrics.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace geosis::server {
namespace {

// Seconds; the last bucket is everything.
constexpr std::array kBounds = {0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1,  0.25,
                                0.5,   1.0,    2.5,   5.0,  10.0,  30.0, 60.0, 300.0};

const char* name_of(Metrics::Kind kind) {
  switch (kind) {
    case Metrics::Kind::counter:
      return "counter";
    case Metrics::Kind::gauge:
      return "gauge";
    case Metrics::Kind::histogram:
      return "histogram";
  }
  return "untyped";
}

std::string number(double value) {
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return std::string(digits.data(), end);
}

void add_escaped(const std::string& value, std::string& text) {
  for (const char c : value) {
    if (c == '\n') {
      text += "\\n";
      continue;
    }
    if (c == '\\' || c == '"') text += '\\';
    text += c;
  }
}

std::string labels_text(const Metrics::Labels& labels) {
  std::string text;
  for (const auto& [name, value] : labels) {
    if (!text.empty()) text += ',';
    text.append(name).append("=\"");
    add_escaped(value, text);
    text += '"';
  }
  return text;
}

void add_line(const std::string& name, const std::string& labels, const std::string& value, std::string& text) {
  text += name;
  if (!labels.empty()) text += "{" + labels + "}";
  text += " " + value + "\n";
}

}  // namespace

Metrics::Metrics(const std::vector<Family>& families) {
  for (const Family& family : families) entries_[family.name] = {family, {}};
}

Metrics::Series* Metrics::series_of(const char* name, Kind kind, const Labels& labels) {
  const auto entry = entries_.find(name);
  if (entry == entries_.end()) return nullptr;
  const bool is_histogram = entry->second.family.kind == Kind::histogram;
  if (is_histogram != (kind == Kind::histogram)) return nullptr;
  Series& series = entry->second.series[labels_text(labels)];
  if (is_histogram) series.buckets.resize(kBounds.size());
  return &series;
}

void Metrics::add(const char* counter, const Labels& labels, double amount) {
  const std::lock_guard lock(mutex_);
  if (Series* const series = series_of(counter, Kind::counter, labels)) series->value += amount;
}

void Metrics::set(const char* gauge_or_counter, const Labels& labels, double value) {
  const std::lock_guard lock(mutex_);
  if (Series* const series = series_of(gauge_or_counter, Kind::gauge, labels)) series->value = value;
}

void Metrics::observe(const char* histogram, const Labels& labels, double seconds) {
  const std::lock_guard lock(mutex_);
  Series* const series = series_of(histogram, Kind::histogram, labels);
  if (series == nullptr) return;
  series->value += seconds;
  ++series->count;
  const auto bound = std::lower_bound(kBounds.begin(), kBounds.end(), seconds);
  if (bound != kBounds.end()) ++series->buckets[static_cast<std::size_t>(bound - kBounds.begin())];
}

void Metrics::write_histogram(const std::string& name, const std::string& labels, const Series& series,
                              std::string& text) {
  const std::string separator = labels.empty() ? "" : ",";
  std::uint64_t below = 0;
  for (std::size_t i = 0; i < kBounds.size(); ++i) {
    below += series.buckets[i];
    add_line(name + "_bucket", labels + separator + "le=\"" + number(kBounds[i]) + "\"", std::to_string(below), text);
  }
  add_line(name + "_bucket", labels + separator + "le=\"+Inf\"", std::to_string(series.count), text);
  add_line(name + "_sum", labels, number(series.value), text);
  add_line(name + "_count", labels, std::to_string(series.count), text);
}

std::string Metrics::text() const {
  const std::lock_guard lock(mutex_);
  std::string text;
  for (const auto& [name, entry] : entries_) {
    text += "# HELP " + name + " " + entry.family.help + "\n# TYPE " + name + " " + name_of(entry.family.kind) + "\n";
    for (const auto& [labels, series] : entry.series) {
      if (entry.family.kind == Kind::histogram) {
        write_histogram(name, labels, series, text);
      } else {
        add_line(name, labels, number(series.value), text);
      }
    }
  }
  return text;
}

}  // namespace geosis::server
