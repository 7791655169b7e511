#pragma once

#include <functional>
#include <string>
#include <vector>

#include "engine/isosurface/extract.h"
#include "tests/property/surface_laws.h"
#include "tests/support/random.h"
#include "tests/support/scalar_field.h"

namespace geosis::test {

/// Random fields of one kind, and ranges to cut them with.
struct Family {
  std::string name;
  std::function<ScalarField(Random&)> field;
  std::function<IsoRange(Random&)> range;
  int fields = 0;                ///< as many as ./test judges
  double most_undecided = 0.01;  ///< share of the fields whose topology may stay uncompared
};

std::vector<Family> families();

using Judge = Verdict (*)(const ScalarField&, IsoRange, BodyMode);

struct Tally {
  int judged = 0, broken = 0, undecided = 0;
  std::string first_broken;
};

/// Judges every stride-th of the family's first `fields` fields.
Tally judge_family(const Family& family, BodyMode mode, Judge judge, std::uint64_t seed, int fields, int stride = 1);

}  // namespace geosis::test
