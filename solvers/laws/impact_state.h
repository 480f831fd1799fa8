#pragma once

namespace taut {

/// Where the location of its impact stands, of an axis at a limit or of a contact: it is let through once, to
/// see when it gets there, and is due at the end of the sub-step that ends then.  (solvers/laws, "Impacts")
class ImpactState {
 public:
  /// It may be let through.
  bool is_open() const { return stage_ == Stage::kNone && !spent_; }
  /// It is let through, to see when it gets there.
  bool sought() const { return stage_ == Stage::kSought; }
  /// It strikes at the end of this sub-step.
  bool due() const { return stage_ == Stage::kDue; }
  /// Either of them.
  bool let_through() const { return stage_ != Stage::kNone; }

  void seek() { stage_ = Stage::kSought; }
  void set_due(bool due) { stage_ = due ? Stage::kDue : Stage::kNone; }
  /// It is let through no more; `for_good`: nor, if it was, again in this step.
  void forget(bool for_good) {
    spent_ = spent_ || (for_good && let_through());
    stage_ = Stage::kNone;
  }

  /// What is remembered from step to step, to or from bytes.
  template <typename AnyArchive>
  void transfer(AnyArchive& archive) {
    archive(stage_, spent_);
  }

 private:
  enum class Stage { kNone, kSought, kDue } stage_ = Stage::kNone;
  bool spent_ = false;
};

}  // namespace taut
