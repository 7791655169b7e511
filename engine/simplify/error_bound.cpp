#include "engine/simplify/error_bound.h"

#include <algorithm>
#include <utility>

namespace geosis {
namespace {

constexpr double kFirstGuess = 0.25;  // estimated error for one voxel of measured distance
constexpr int kMostGuesses = 5;
constexpr double kSafety = 0.9;        // of a corrected guess
constexpr double kCloseEnough = 0.75;  // of the bound: not worth another guess

LodLevel level_of(const Reducer& reducer) {
  LodLevel level = reducer.snapshot();
  level.cost = reducer.max_cost();
  return level;
}

}  // namespace

std::optional<LodLevel> reduce_within(Reducer& reducer, double max_error,
                                      const std::function<double(const IndexedMesh&)>& measure, PassEnd& end) {
  LodLevel best = level_of(reducer);
  best.error = measure(best.mesh);
  if (best.error > max_error) return std::nullopt;
  Reducer state = reducer;
  double guess = kFirstGuess * max_error;
  for (int i = 0; i < kMostGuesses; ++i) {
    Reducer attempt = state;
    Goal goal;
    goal.max_error = static_cast<float>(guess);
    end = attempt.reduce(goal);
    if (end != PassEnd::done) return std::nullopt;
    LodLevel level = level_of(attempt);
    level.error = measure(level.mesh);
    const double correction = level.error > 0 ? max_error / level.error : 4.0;
    if (level.error <= max_error && level.mesh.triangles.size() <= best.mesh.triangles.size()) {
      best = std::move(level);
      reducer = std::move(attempt);
      if (best.error >= kCloseEnough * max_error || reducer.stopped_by() == StoppedBy::floor) break;
    }
    guess *= std::clamp(kSafety * correction, 0.25, 4.0);
  }
  return best;
}

}  // namespace geosis
