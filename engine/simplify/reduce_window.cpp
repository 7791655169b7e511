#include "engine/simplify/reduce_window.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/simplify/reduce_window.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "engine/simplify/lanes/collapser.h"

HWY_BEFORE_NAMESPACE();
namespace geosis {
namespace HWY_NAMESPACE {

bool ReduceWindow(WindowState& window, const Goal& goal, const Rules& rules, Watch& watch) {
  return Collapser(window, goal, rules, watch).reduce();
}

}  // namespace HWY_NAMESPACE
}  // namespace geosis
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geosis {

HWY_EXPORT(ReduceWindow);

bool reduce_window(WindowState& window, const Goal& goal, const Rules& rules, Watch& watch) {
  return HWY_DYNAMIC_DISPATCH(ReduceWindow)(window, goal, rules, watch);
}

}  // namespace geosis
#endif
