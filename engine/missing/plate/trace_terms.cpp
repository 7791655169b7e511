#include "engine/missing/plate/trace_terms.h"

#include <algorithm>

namespace geosis {
namespace {

// Loops over a row are kept small and take few arrays each: compilers make vector code of them then.

/// Factors of the samples 0, 1, 2, 3 in the cubic at x.
void cubic_factors(const float* x, float* f0, float* f1, float* f2, float* f3, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    const float a = x[k], b = a - 1, c = a - 2, d = a - 3;
    f0[k] = b * c * d * (-1.0f / 6);
    f1[k] = 0.5f * a * c * d;
    f2[k] = -0.5f * a * b * d;
    f3[k] = a * b * c * (1.0f / 6);
  }
}

/// Where the four samples around each depth begin, inside the trace, and the depth counted from there.
void split_depths(const float* depth, std::int32_t* base, float* rest, std::int32_t last_base, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    std::int32_t above = static_cast<std::int32_t>(depth[k]) - 1;
    above = above > 0 ? above : 0;
    above = above < last_base ? above : last_base;
    base[k] = above;
    rest[k] = depth[k] - static_cast<float>(above);
  }
}

/// term *= weight * ((after - middle) - (middle - before))
void bend(float* term, float weight, const float* before, const float* middle, const float* after, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    term[k] *= weight * ((after[k] - middle[k]) - (middle[k] - before[k]));
  }
}

/// term *= weight * ((d - c) - (b - a))
void twist(float* term, float weight, const float* a, const float* b, const float* c, const float* d,
           std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) term[k] *= weight * ((d[k] - c[k]) - (b[k] - a[k]));
}

/// out = bent + minus * (twisted + falling) + falling of the sample above
void give_next(float* out, float minus, const float* bent, const float* twisted, const float* falling,
               std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    out[k] = bent[k] + minus * (twisted[k] + falling[k]) + falling[static_cast<std::ptrdiff_t>(k) - 1];
  }
}

/// out += factor * (a + b)
void add_times(float* out, float factor, const float* a, const float* b, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) out[k] += factor * (a[k] + b[k]);
}

void multiply(float* row, float factor, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) row[k] *= factor;
}

}  // namespace

TraceTerms::TraceTerms(std::int32_t samples) : samples_(samples), own_(static_cast<std::size_t>(samples) + 3, 0.0f) {
  for (Taps& taps : taps_) {
    taps.base.assign(own_.size(), 0);
    for (Row& row : taps.factor) row = own_;
  }
  for (Row& row : lateral_) row = own_;
  for (Row& row : term_) row = own_;
}

void TraceTerms::select(const std::uint8_t* set, std::int32_t first, std::int32_t end) {
  first_ = first;
  end_ = end;
  reached_ = std::min(end + 1, samples_);
  for (std::size_t n = 0; n < terms; ++n) {
    float* term = &term_[n][place(0)];
    term[first - 1] = term[end] = term[end + 1] = 0;
    for (std::int32_t k = first; k < end; ++k) term[k] = static_cast<float>(set[k] >> n & 1);
  }
}

void TraceTerms::aim(Neighbour n, const float* depth, std::int32_t first, std::int32_t end) {
  Taps& taps = taps_[n];
  const auto count = static_cast<std::size_t>(end - first);
  const std::size_t at = place(first);
  float* rest = &lateral_[n][at];  // free until values are loaded
  split_depths(depth + first, &taps.base[at], rest, std::max(samples_ - 4, 0), count);
  cubic_factors(rest, &taps.factor[0][at], &taps.factor[1][at], &taps.factor[2][at], &taps.factor[3][at], count);
}

void TraceTerms::load_own(const float* trace) {
  const std::int32_t from = std::max(first_ - 1, 0);
  std::copy(trace + from, trace + reached_, &own_[place(from)]);
}

void TraceTerms::load_neighbour(Neighbour n, const float* trace) {
  const Taps& taps = taps_[n];
  for (std::size_t k = place(first_); k < place(reached_); ++k) {
    const float* x = trace + taps.base[k];
    lateral_[n][k] =
        taps.factor[0][k] * x[0] + taps.factor[1][k] * x[1] + taps.factor[2][k] * x[2] + taps.factor[3][k] * x[3];
  }
}

void TraceTerms::evaluate(const std::array<float, terms>& weight) {
  const std::size_t at = place(first_);
  const auto count = static_cast<std::size_t>(end_ - first_);
  const float* f = &own_[at];
  const float* after_i = &lateral_[next_inline][at];
  const float* after_j = &lateral_[next_crossline][at];
  bend(&term_[ii][at], weight[ii], &lateral_[previous_inline][at], f, after_i, count);
  bend(&term_[jj][at], weight[jj], &lateral_[previous_crossline][at], f, after_j, count);
  bend(&term_[kk][at], weight[kk], f - 1, f, f + 1, count);
  twist(&term_[ij][at], weight[ij], f, after_i, after_j, &lateral_[corner][at], count);
  twist(&term_[ik][at], weight[ik], f, after_i, f + 1, after_i + 1, count);
  twist(&term_[jk][at], weight[jk], f, after_j, f + 1, after_j + 1, count);
}

void TraceTerms::give_back() {
  collect(-1, -2);
}

void TraceTerms::give_back_squares(const std::array<float, terms>& weight) {
  const auto count = static_cast<std::size_t>(end_ - first_);
  for (std::size_t n = 0; n < terms; ++n) multiply(&term_[n][place(first_)], weight[n], count);
  for (Taps& taps : taps_) {
    for (Row& factor : taps.factor) {
      for (std::size_t k = place(first_); k < place(reached_); ++k) factor[k] *= factor[k];
    }
  }
  collect(1, 4);
}

void TraceTerms::collect(float minus, float middle) {
  // A term at k reaches k - 1 and k + 1, and no term lies outside first ... end - 1.
  const std::size_t at = place(first_);
  const auto count = static_cast<std::size_t>(end_ - first_) + 1;
  const float *in_i = &term_[ii][at], *in_j = &term_[jj][at], *in_k = &term_[kk][at];
  const float *in_ij = &term_[ij][at], *in_ik = &term_[ik][at], *in_jk = &term_[jk][at];
  give_next(&lateral_[next_inline][at], minus, in_i, in_ij, in_ik, count);
  give_next(&lateral_[next_crossline][at], minus, in_j, in_ij, in_jk, count);
  std::copy_n(in_i, count, &lateral_[previous_inline][at]);
  std::copy_n(in_j, count, &lateral_[previous_crossline][at]);
  std::copy_n(in_ij, count, &lateral_[corner][at]);
  float* own = &own_[at];
  own[-1] = in_k[0];
  for (std::size_t k = 0; k < count; ++k) own[k] = in_ij[k] + middle * in_k[k];
  add_times(own, middle, in_i, in_j, count);
  add_times(own, 1, in_ik, in_jk, count);
  add_times(own, minus, in_ik - 1, in_jk - 1, count);
  add_times(own, 1, in_k - 1, in_k + 1, count);
}

void TraceTerms::store_own(float* trace) const {
  for (std::int32_t k = std::max(first_ - 1, 0); k < reached_; ++k) trace[k] += own_[place(k)];
}

void TraceTerms::store_neighbour(Neighbour n, float* trace) const {
  const Taps& taps = taps_[n];
  const float* row = lateral_[n].data();
  for (std::size_t k = place(first_); k < place(reached_); ++k) {
    float* x = trace + taps.base[k];
    for (std::size_t t = 0; t < 4; ++t) x[t] += taps.factor[t][k] * row[k];
  }
}

}  // namespace geosis
