#include "server/metrics/metrics.h"

#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace geosis::server {
namespace {

using Kind = Metrics::Kind;

TEST(Metrics, WritesCountersAndGaugesWithTheirLabels) {
  Metrics metrics({{"b_total", Kind::counter, "What b is."}, {"a", Kind::gauge, "What a is."}});
  metrics.add("b_total", {{"kind", "x"}});
  metrics.add("b_total", {{"kind", "x"}}, 2.5);
  metrics.add("b_total", {{"kind", "say \"hi\"\\\n"}});
  metrics.set("a", {}, 7);
  metrics.set("a", {}, 12345678901.0);
  EXPECT_EQ(metrics.text(),
            "# HELP a What a is.\n# TYPE a gauge\na 12345678901\n"
            "# HELP b_total What b is.\n# TYPE b_total counter\n"
            "b_total{kind=\"say \\\"hi\\\"\\\\\\n\"} 1\nb_total{kind=\"x\"} 3.5\n");
}

TEST(Metrics, BucketsOfAHistogramHoldAllBelowThem) {
  Metrics metrics({{"t_seconds", Kind::histogram, "Times."}});
  for (const double seconds : {0.0005, 0.001, 0.3, 1000.0}) metrics.observe("t_seconds", {{"route", "/x"}}, seconds);
  const std::string text = metrics.text();
  for (const std::string line :
       {"t_seconds_bucket{route=\"/x\",le=\"0.001\"} 2\n", "t_seconds_bucket{route=\"/x\",le=\"0.25\"} 2\n",
        "t_seconds_bucket{route=\"/x\",le=\"0.5\"} 3\n", "t_seconds_bucket{route=\"/x\",le=\"300\"} 3\n",
        "t_seconds_bucket{route=\"/x\",le=\"+Inf\"} 4\n", "t_seconds_sum{route=\"/x\"} 1000.3015\n",
        "t_seconds_count{route=\"/x\"} 4\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line << text;
  }
}

TEST(Metrics, NeitherUnknownNamesNorOtherKindsAreCounted) {
  Metrics metrics({{"c_total", Kind::counter, "C."}});
  metrics.add("d_total");
  metrics.observe("c_total", {}, 1);
  EXPECT_EQ(metrics.text(), "# HELP c_total C.\n# TYPE c_total counter\n");
}

TEST(Metrics, CountWhatManyThreadsAdd) {
  Metrics metrics({{"c_total", Kind::counter, "C."}});
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&] {
        for (int i = 0; i < 1000; ++i) metrics.add("c_total");
      });
    }
    EXPECT_NE(metrics.text(), "");
  }
  EXPECT_NE(metrics.text().find("c_total 4000\n"), std::string::npos);
}

}  // namespace
}  // namespace geosis::server
