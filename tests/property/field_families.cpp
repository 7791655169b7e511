#include "tests/property/field_families.h"

#include <limits>

#include "tests/support/phantoms.h"

namespace geosis::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr GridShape kSmall{5, 5, 5};

ScalarField noise(Random& random) {
  return uniform_noise(kSmall, random, -1, 1);
}
ScalarField scaled(ScalarField field, float scale) {
  for (float& f : field.samples) f *= scale;
  return field;
}
IsoRange above(Random& random) {
  return {random.between(-0.4f, 0.4f), kInf};
}
IsoRange under(Random& random) {
  return {-kInf, random.between(-0.4f, 0.4f)};
}
IsoRange band(Random& random) {
  return {random.between(-0.6f, 0), random.between(0, 0.6f)};
}
IsoRange slab(Random& random) {
  const float level = random.between(-0.4f, 0.4f);
  return {level, level};
}
IsoRange whole_levels(Random& random) {
  const auto low = static_cast<float>(random.integer(-2, 1));
  return {low, low + static_cast<float>(random.integer(0, 2))};
}

}  // namespace

std::vector<Family> families() {
  const auto closed = [](Random& r) { return with_outer_layer(noise(r), -2); };
  const auto holes = [](Random& r) { return with_holes(noise(r), r, 0.02 + 0.08 * r.unit()); };
  return {
      {"OpenAbove", noise, above, 1000},
      {"OpenUnder", noise, under, 500},
      {"OpenBand", noise, band, 1000},
      {"ClosedAbove", closed, above, 1000},
      {"ClosedBand", closed, band, 1000},
      {"Slab", noise, slab, 300},
      {"HolesAbove", holes, above, 300},
      {"HolesBand", holes, band, 300},
      {"Tiny", [](Random& r) { return scaled(noise(r), 1e-4f); },
       [](Random& r) {
         return IsoRange{1e-4f * r.between(-0.4f, 0), 1e-4f * r.between(0, 0.4f)};
       },
       300},
      {"Huge", [](Random& r) { return scaled(noise(r), 1e5f); },
       [](Random& r) {
         return IsoRange{1e5f * r.between(-0.4f, 0), 1e5f * r.between(0, 0.4f)};
       },
       300},
      {"Bigger",
       [](Random& r) {
         return uniform_noise({8, 9, 10}, r, -1, 1);
       },
       band, 60},
      {"OpenEight",
       [](Random& r) {
         return uniform_noise({8, 8, 8}, r, -1, 1);
       },
       above, 60},
      {"ClosedEight",
       [](Random& r) {
         return with_outer_layer(uniform_noise({8, 8, 8}, r, -1, 1), -2);
       },
       above, 60},
      {"Holes2Percent", [](Random& r) { return with_holes(noise(r), r, 0.02); }, band, 200},
      {"Flat",
       [](Random& r) {
         return uniform_noise({2, 6, 3}, r, -1, 1);
       },
       band, 300},
      // Saddles of small whole numbers often lie on a whole level; samples on the level do not make a tie.
      {"SmallIntegers", [](Random& r) { return integer_noise(kSmall, r, -3, 3); }, whole_levels, 300, 1},
      {"ZeroesAndNearTies",
       [](Random& r) {
         return integer_noise({3, 3, 4}, r, -40, 40);
       },
       [](Random& r) {
         return IsoRange{0, static_cast<float>(r.integer(0, 30))};
       },
       300, 0.5},
  };
}

Tally judge_family(const Family& family, BodyMode mode, Judge judge, std::uint64_t seed, int fields, int stride) {
  Random random(seed);
  Tally tally;
  for (int trial = 0; trial < fields; ++trial) {
    const ScalarField field = family.field(random);
    const IsoRange range = family.range(random);
    if (trial % stride != 0) continue;
    const Verdict verdict = judge(field, range, mode);
    ++tally.judged;
    tally.undecided += !verdict.decided;
    if (verdict.broken.empty() || tally.broken++ > 0) continue;
    tally.first_broken = "seed " + std::to_string(seed) + ", field " + std::to_string(trial) + ": " + verdict.broken;
  }
  return tally;
}

}  // namespace geosis::test
