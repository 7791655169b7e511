// Work on large meshes asks often whether to go on, and ends where it is told to.
#include <atomic>
#include <cstdint>
#include <functional>

#include <gtest/gtest.h>

#include "engine/analysis/surface_distance.h"
#include "engine/analysis/surface_measures.h"
#include "engine/analysis/topology_report.h"
#include "engine/base/stretches.h"
#include "engine/volume/geometry.h"
#include "tests/support/lattice_meshes.h"

namespace geosis {
namespace {

/// Counts how often it is asked, and cancels from one of the questions on.
class CountedAsks final : public Progress {
 public:
  explicit CountedAsks(int cancels_at = -1) : cancels_at_(cancels_at) {}
  void report(const char*, double) override {}
  bool cancelled() const override {
    const int number = asks_++;
    return cancels_at_ >= 0 && number >= cancels_at_;
  }
  int asks() const { return asks_; }

 private:
  const int cancels_at_;
  mutable std::atomic<int> asks_ = 0;
};

using Work = std::function<Result<void>(const Progress&)>;

template <class Value>
Result<void> outcome(const Result<Value>& result) {
  return result ? Result<void>() : Result<void>(result.error());
}

/// The work walks over `passes` times the triangles at least, asks once a stretch of each walk, and whichever question
/// cancels it is the last one.
void expect_asks(const IndexedMesh& mesh, int passes, const Work& work) {
  const auto stretches = static_cast<int>((mesh.triangles.size() - 1) / Stretches::kLength) + 1;
  ASSERT_GE(stretches, 3);
  const CountedAsks never;
  ASSERT_TRUE(work(never));
  EXPECT_GE(never.asks(), passes * stretches);
  for (int n = 0; n < never.asks(); n += 3) {
    const CountedAsks progress(n);
    const auto ended = work(progress);
    ASSERT_FALSE(ended) << n;
    EXPECT_EQ(ended.error().code, ErrorCode::cancelled);
    EXPECT_EQ(progress.asks(), n + 1);
  }
}

IndexedMesh sphere() {
  return test::sphere({50, 50, 50}, 40, 200, 400);  // 159,200 triangles
}

TEST(Cancellation, OfATopologyReport) {
  const IndexedMesh mesh = sphere();
  expect_asks(mesh, 20, [&](const Progress& progress) { return outcome(report_topology(mesh, progress)); });
}

TEST(Cancellation, OfATopologyReportThatIsNotManifold) {
  IndexedMesh mesh = sphere();
  const std::size_t triangles = mesh.triangles.size();
  const TopologyReport sound = report_topology(mesh);
  mesh.triangles.push_back(mesh.triangles.back());
  const TopologyReport twice = report_topology(mesh);
  EXPECT_FALSE(twice.manifold);
  EXPECT_EQ(twice.triangles, static_cast<std::int64_t>(triangles) + 1);
  EXPECT_EQ(twice.euler, sound.euler + 1);  // one triangle more, and no edge
  expect_asks(mesh, 5, [&](const Progress& progress) { return outcome(report_topology(mesh, progress)); });
}

TEST(Cancellation, OfMeasures) {
  const IndexedMesh mesh = sphere();
  const AffineGeometry geometry;
  expect_asks(mesh, 1, [&](const Progress& progress) { return outcome(measure_surface(mesh, geometry, progress)); });
}

TEST(Cancellation, OfDistances) {
  const IndexedMesh mesh = sphere(), other = test::sphere({50, 50, 50}, 41, 200, 400);
  const DistanceOptions options{.samples = 2'000};
  const ReferenceSurface prepared(mesh, options);
  expect_asks(mesh, 6, [&](const Progress& progress) { return outcome(prepared.measure(other, progress)); });
}

TEST(Cancellation, OfWhatDistancesAreMeasuredFrom) {
  const IndexedMesh mesh = sphere();
  const CountedAsks never;
  EXPECT_TRUE(ReferenceSurface(mesh, {.samples = 100}, never).measure(mesh));
  for (int n = 0; n < never.asks(); n += 2) {
    const auto distance = ReferenceSurface(mesh, {.samples = 100}, CountedAsks(n)).measure(mesh);
    ASSERT_FALSE(distance) << n;
    EXPECT_EQ(distance.error().code, ErrorCode::cancelled);
  }
}

}  // namespace
}  // namespace geosis
