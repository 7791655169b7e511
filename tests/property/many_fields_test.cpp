#include <chrono>
#include <iostream>
#include <string>

#include <gtest/gtest.h>

#include "tests/property/field_families.h"

// 20,000 random fields over all families, each judged with a cap and without, in both modes: `./test -L slow`.

namespace geosis::test {
namespace {

constexpr int kFields = 20'000;

TEST(ManyFields, HaveTheTopologyOfTheirBodies) {
  const std::uint64_t seed = test_seed(20'000);
  const std::vector<Family> all = families();
  const auto started = std::chrono::steady_clock::now();
  int fields = 0, judged = 0, undecided = 0;
  for (std::size_t n = 0; n < all.size(); ++n) {
    const int share = static_cast<int>(kFields * (n + 1) / all.size() - kFields * n / all.size());
    Tally of_family;
    for (const BodyMode mode : {BodyMode::exact, BodyMode::sampled}) {
      for (const Judge judge : {judge_closed_surface, judge_open_surface}) {
        const Tally tally = judge_family(all[n], mode, judge, seed + n, share);
        EXPECT_EQ(tally.broken, 0) << all[n].name << ": " << tally.first_broken;
        of_family.judged += tally.judged, of_family.undecided += tally.undecided;
      }
    }
    std::cout << all[n].name << ": " << share << " fields, undecided in " << of_family.undecided << " of "
              << of_family.judged << " judgements\n";
    EXPECT_LE(of_family.undecided, all[n].most_undecided * of_family.judged) << all[n].name;
    fields += share, judged += of_family.judged, undecided += of_family.undecided;
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - started;
  std::cout << fields << " fields, " << judged << " judgements, " << undecided << " undecided, seed " << seed << ", "
            << seconds.count() << " s\n";
  EXPECT_EQ(fields, kFields);
}

}  // namespace
}  // namespace geosis::test
