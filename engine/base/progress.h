#pragma once

namespace geosis {

/// How long work tells how far it is and learns that nobody wants it any more.
///
/// One stage at a time reports fractions in [0, 1]; report() and cancelled() may be called from any thread.
/// Stages ask cancelled() at brick or batch granularity (at least every 50 ms) and return ErrorCode::cancelled.
class Progress {
 public:
  virtual ~Progress() = default;
  virtual void report(const char* stage, double fraction) = 0;
  virtual bool cancelled() const = 0;
};

/// For callers that neither watch nor cancel.
class NoProgress final : public Progress {
 public:
  void report(const char*, double) override {}
  bool cancelled() const override { return false; }
};

}  // namespace geosis
