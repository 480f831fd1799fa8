// Numeric factorisation and solve of MultifrontalFactor against bare CHOLMOD, supernodal and simplicial, on
// the matrices of nets and chains of ball joints.  All factors of a matrix take turns within one benchmark,
// so that a busy machine slows each of them alike; the counters are medians of thread CPU time.  Everything
// runs on one thread.
#include <benchmark/benchmark.h>
#include <dlfcn.h>
#include <omp.h>
#include <time.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "benchmarks/block_problem.h"
#include "benchmarks/timing.h"
#include "solvers/linear/multifrontal_factor.h"

namespace {

using namespace taut;
using namespace taut::benchmarks;

// One BLAS thread, and no nested parallel regions: CHOLMOD 5.12 opens them for small scatter loops, with more
// threads than cores.
void use_one_thread() {
  if (auto* set = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))) set(1);
  omp_set_max_active_levels(0);
}

struct Timings {
  std::vector<double> factorize, solve;
};

void factors(benchmark::State& state, const BlockEdges& graph) {
  use_one_thread();
  const SymmetricMatrix A = block_matrix(graph, amd_places(graph));
  MultifrontalFactor multifrontal;
  const double analyze = cpu_seconds_of([&] { multifrontal.analyze(A); });
  BareCholmod supernodal(A, true), simplicial(A, false);
  std::vector<double> x(static_cast<std::size_t>(A.size()), 1.0);
  Timings own, super, simple;
  bool failed = multifrontal.factorize(A) >= 0;
  for (auto _ : state) {
    own.factorize.push_back(cpu_seconds_of([&] { failed = multifrontal.factorize(A) >= 0 || failed; }));
    state.SetIterationTime(own.factorize.back());
    own.solve.push_back(cpu_seconds_of([&] { multifrontal.solve(x); }));
    super.factorize.push_back(cpu_seconds_of([&] { supernodal.factorize(); }));
    super.solve.push_back(cpu_seconds_of([&] { supernodal.solve(); }));
    simple.factorize.push_back(cpu_seconds_of([&] { simplicial.factorize(); }));
    simple.solve.push_back(cpu_seconds_of([&] { simplicial.solve(); }));
    std::fill(x.begin(), x.end(), 1.0);
  }
  if (failed) state.SkipWithError("not positive definite");
  const double factorize = median(own.factorize), solve = median(own.solve);
  state.counters["rows"] = A.size();
  state.counters["Mflop"] = 1e-6 * multifrontal.flops();
  state.counters["Mflop_cholmod"] = 1e-6 * supernodal.flops();
  state.counters["nnz_L"] = static_cast<double>(multifrontal.nonzeros());
  state.counters["GFLOP/s"] = 1e-9 * multifrontal.flops() / factorize;
  state.counters["analyze_ms"] = 1e3 * analyze;
  state.counters["factor_ms"] = 1e3 * factorize;
  state.counters["factor_supernodal_ms"] = 1e3 * median(super.factorize);
  state.counters["factor_simplicial_ms"] = 1e3 * median(simple.factorize);
  state.counters["factor_vs_supernodal"] = median(super.factorize) / factorize;
  state.counters["factor_vs_simplicial"] = median(simple.factorize) / factorize;
  state.counters["solve_ms"] = 1e3 * solve;
  state.counters["solve_vs_supernodal"] = median(super.solve) / solve;
  state.counters["solve_vs_simplicial"] = median(simple.solve) / solve;
}

void net(benchmark::State& state) { factors(state, net_graph(static_cast<int>(state.range(0)))); }
void chain(benchmark::State& state) { factors(state, chain_graph(static_cast<int>(state.range(0)))); }

// The limit of this core: C = A Bᵀ of 500 × 500 with the BLAS that CHOLMOD uses.
void dgemm(benchmark::State& state) {
  use_one_thread();
  using Dgemm =
      void(const char*, const char*, const int*, const int*, const int*, const double*, const double*,
           const int*, const double*, const int*, const double*, double*, const int*);
  auto* multiply = reinterpret_cast<Dgemm*>(dlsym(RTLD_DEFAULT, "dgemm_"));
  if (multiply == nullptr) return state.SkipWithError("no BLAS in this program");
  const int n = 500;
  const double one = 1.0, zero = 0.0;
  std::vector<double> A(n * n, 1.0), C(n * n), times;
  for (auto _ : state) {
    times.push_back(cpu_seconds_of(
        [&] { multiply("N", "T", &n, &n, &n, &one, A.data(), &n, A.data(), &n, &zero, C.data(), &n); }));
    state.SetIterationTime(times.back());
  }
  state.counters["GFLOP/s"] = 2e-9 * n * n * n / median(times);
}

BENCHMARK(dgemm)->UseManualTime()->Unit(benchmark::kMillisecond);
BENCHMARK(net)
    ->Arg(5)
    ->Arg(10)
    ->Arg(20)
    ->Arg(40)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(100);
BENCHMARK(net)->Arg(80)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(20);
BENCHMARK(net)->Arg(160)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK(chain)
    ->Arg(10)
    ->Arg(100)
    ->Arg(1000)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1000);
BENCHMARK(chain)->Arg(10000)->Arg(100000)->UseManualTime()->Unit(benchmark::kMillisecond)->Iterations(50);

}  // namespace
