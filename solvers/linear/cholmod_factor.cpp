#include "solvers/linear/cholmod_factor.h"

#include <cholmod.h>
#include <omp.h>
#if __has_include(<dlfcn.h>)
#include <dlfcn.h>
#endif

#include <algorithm>
#include <new>
#include <stdexcept>
#include <vector>

namespace taut {
namespace {

/// CHOLMOD of SuiteSparse 5.12 as Debian builds it runs small scatter loops with a fixed num_threads(4),
/// which OMP_NUM_THREADS does not reach and which costs more than they.  No active levels, no threads.
/// (solvers/linear, "CHOLMOD")
class NoNestedThreads {
 public:
  NoNestedThreads() : levels_(omp_get_max_active_levels()) { omp_set_max_active_levels(0); }
  ~NoNestedThreads() { omp_set_max_active_levels(levels_); }
  NoNestedThreads(const NoNestedThreads&) = delete;
  NoNestedThreads& operator=(const NoNestedThreads&) = delete;

 private:
  int levels_;
};

/// What a library of this process offers by that name; nullptr if none does, or if nobody can be asked.
void* symbol_of([[maybe_unused]] const char* name) {
#if __has_include(<dlfcn.h>)
  return dlsym(RTLD_DEFAULT, name);
#else
  return nullptr;
#endif
}

/// The front sizes met here are far too small for a threaded BLAS.
void use_one_blas_thread() {
  using SetThreads = void (*)(int);
  if (auto* symbol = symbol_of("openblas_set_num_threads")) reinterpret_cast<SetThreads>(symbol)(1);
}

/// Views without copies.
cholmod_sparse view(const SymmetricMatrix& A) {
  cholmod_sparse sparse{};
  sparse.nrow = sparse.ncol = A.size();
  sparse.nzmax = A.row_index.size();
  sparse.p = const_cast<int*>(A.column_start.data());
  sparse.i = const_cast<int*>(A.row_index.data());
  sparse.x = const_cast<double*>(A.values.data());
  sparse.stype = A.triangle == SymmetricMatrix::Triangle::kLower ? -1 : 1;
  sparse.itype = CHOLMOD_INT;
  sparse.xtype = CHOLMOD_REAL;
  sparse.dtype = CHOLMOD_DOUBLE;
  sparse.sorted = true;
  sparse.packed = true;
  return sparse;
}

cholmod_dense view(std::span<double> x) {
  cholmod_dense dense{};
  dense.nrow = dense.d = dense.nzmax = x.size();
  dense.ncol = 1;
  dense.x = x.data();
  dense.xtype = CHOLMOD_REAL;
  dense.dtype = CHOLMOD_DOUBLE;
  return dense;
}

}  // namespace

class CholmodFactor::Impl {
 public:
  explicit Impl(Method method) : method_(method) {
    cholmod_start(&common_);
    common_.print = 0;
    // The matrix comes ordered and postordered; with the natural order CHOLMOD copies nothing in a
    // factorisation.
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_NATURAL;
    common_.postorder = false;
    common_.supernodal = method == Method::kSupernodal ? CHOLMOD_SUPERNODAL : CHOLMOD_SIMPLICIAL;
    use_one_blas_thread();
  }
  ~Impl() {
    cholmod_free_dense(&x_, &common_);
    cholmod_free_dense(&y_, &common_);
    cholmod_free_dense(&e_, &common_);
    cholmod_free_factor(&L_, &common_);
    cholmod_finish(&common_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  Method method_;
  cholmod_common common_;
  cholmod_factor* L_ = nullptr;
  cholmod_dense *x_ = nullptr, *y_ = nullptr, *e_ = nullptr;
  double flops_ = 0, nonzeros_ = 0;
  std::vector<double> pivots_;  // relative
};

CholmodFactor::CholmodFactor(Method method) : impl_(std::make_unique<Impl>(method)) {}
CholmodFactor::~CholmodFactor() = default;

SymmetricMatrix::Triangle CholmodFactor::triangle() const {
  return impl_->method_ == Method::kSupernodal ? SymmetricMatrix::Triangle::kLower
                                               : SymmetricMatrix::Triangle::kUpper;
}

void CholmodFactor::analyze(const SymmetricMatrix& A) {
  if (A.size() == 0) return;  // a world without joints
  cholmod_sparse S = view(A);
  cholmod_free_factor(&impl_->L_, &impl_->common_);
  impl_->L_ = cholmod_analyze(&S, &impl_->common_);
  if (!impl_->L_)
    throw std::runtime_error("CHOLMOD's analysis failed, status " + std::to_string(impl_->common_.status));
  impl_->pivots_.assign(A.size(), 0.0);
  impl_->flops_ = impl_->common_.fl;
  impl_->nonzeros_ = impl_->common_.lnz;
}

int CholmodFactor::factorize(const SymmetricMatrix& A) {
  if (A.size() == 0) return -1;
  const NoNestedThreads guard;
  cholmod_sparse S = view(A);
  cholmod_factorize(&S, impl_->L_, &impl_->common_);
  if (impl_->common_.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
  if (impl_->L_->minor < impl_->L_->n) return static_cast<int>(impl_->L_->minor);
  read_pivots(A);
  return -1;
}

void CholmodFactor::solve(std::span<double> x) {
  if (x.empty()) return;
  const NoNestedThreads guard;
  cholmod_dense b = view(x);
  if (!cholmod_solve2(CHOLMOD_A, impl_->L_, &b, nullptr, &impl_->x_, nullptr, &impl_->y_, &impl_->e_,
                      &impl_->common_))
    throw std::bad_alloc();
  const auto* solution = static_cast<const double*>(impl_->x_->x);
  std::copy(solution, solution + x.size(), x.begin());
}

std::span<const double> CholmodFactor::relative_pivots() const { return impl_->pivots_; }

void CholmodFactor::read_pivots(const SymmetricMatrix& A) {
  std::vector<double>& d = impl_->pivots_;
  const auto divide_by_diagonal = [&] {
    for (int c = 0; c < A.size(); ++c) {
      const auto rows = A.row_index.begin();
      const auto at = std::lower_bound(rows + A.column_start[c], rows + A.column_start[c + 1], c);
      d[c] /= A.values[at - rows];
    }
  };
  const cholmod_factor& L = *impl_->L_;
  const auto* values = static_cast<const double*>(L.x);
  if (!L.is_super) {
    const auto* column = static_cast<const int*>(L.p);
    for (std::size_t i = 0; i < d.size(); ++i)
      d[i] = L.is_ll ? values[column[i]] * values[column[i]] : values[column[i]];
    return divide_by_diagonal();
  }
  const auto *super = static_cast<const int*>(L.super), *start = static_cast<const int*>(L.pi),
             *panel = static_cast<const int*>(L.px);
  for (std::size_t s = 0; s < L.nsuper; ++s) {
    const int height = start[s + 1] - start[s];
    for (int c = 0; c < super[s + 1] - super[s]; ++c) {
      const double diagonal = values[panel[s] + c * height + c];
      d[super[s] + c] = diagonal * diagonal;
    }
  }
  divide_by_diagonal();
}

std::string CholmodFactor::name() const {
  int version[3];
  cholmod_version(version);
  return "CHOLMOD " + std::to_string(version[0]) + "." + std::to_string(version[1]) + "." +
         std::to_string(version[2]) + (impl_->method_ == Method::kSupernodal ? " supernodal" : " simplicial");
}

double CholmodFactor::flops() const { return impl_->flops_; }
std::int64_t CholmodFactor::nonzeros() const { return static_cast<std::int64_t>(impl_->nonzeros_); }

bool CholmodFactor::has_supernodal() {
  static const bool present = [] {
    CholmodFactor probe(Method::kSupernodal);
    SymmetricMatrix one{.block_start = {0, 1}, .column_start = {0, 1}, .row_index = {0}, .values = {1.0}};
    try {
      probe.analyze(one);
      return probe.factorize(one) == -1 && probe.impl_->L_->is_super;
    } catch (const std::runtime_error&) {
      return false;
    }
  }();
  return present;
}

std::string blas_name() {
  using Config = char* (*)();
  if (auto* symbol = symbol_of("openblas_get_config")) return reinterpret_cast<Config>(symbol)();
  // CHOLMOD without its GPL modules needs none.
  return symbol_of("dgemm_") ? "a BLAS that does not tell its name" : "no BLAS";
}

}  // namespace taut
