// SPDX-License-Identifier: GPL-2.0-or-later
// Measures for the roofline, on one thread: steps of the kernels on a square sheet, and the machine's limits.
// Answers in one line of JSON. The steps alone are seen by callgrind, if it starts without instrumentation.
#include "pkg/membrane/kernels/CreaseKernel.hpp"
#include "pkg/membrane/kernels/DragKernel.hpp"
#include "pkg/membrane/kernels/SideKernel.hpp"
#include "pkg/membrane/kernels/Sweep.hpp"
#include "pkg/membrane/mechanics/Damping.hpp"
#include "tests/shapes.hpp"
#include <cstdio>
#include <ctime>
#include <immintrin.h>
#include <string>
#include <valgrind/callgrind.h>

using namespace membrane;

namespace {

/// Processor time [s].
double now() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// ---------------------------------------------------------------------------------------------------------------------
// The sheet: in speed that of benchmarks/sheet.py. The values of its constants do not matter, only which are alike.

constexpr int rowsAFold = 4;          ///< every fourth row of sides is a fold line
constexpr double perturbation = 1e-4; ///< of the nodes' places [m]

struct Model {
    RestState rest;
    std::vector<Eigen::Vector3i> triangles;
    std::shared_ptr<SideForces> sides;
    std::shared_ptr<CreaseForce> creases; ///< null: none
    std::shared_ptr<DragForce> drag;      ///< null: none
    Sweep sweep;
    SweepStep step;

    /// \param everything creases and drag, too
    Model(int side, bool everything) {
        MeshInput in = shapes::sheet(side - 1, side - 1, 0., 1, false);
        for (int j = rowsAFold; everything && j + 1 < side; j += rowsAFold)
            for (int i = 0; i + 1 < side; ++i) {
                in.creases.emplace_back(j * side + i, j * side + i + 1);
                in.creaseSigns.push_back(j / rowsAFold % 2 ? 1 : -1);
            }
        rest = restState(in);
        triangles = in.triangles;
        double stiffest = 0., lightest = rest.masses[0];
        std::vector<double> damping;
        for (const Side& s : rest.sides) {
            damping.push_back(dampingCoefficient(0.02, s.stiffness, 0.5 * (rest.masses[s.a] + rest.masses[s.b])));
            stiffest = std::max(stiffest, s.stiffness);
        }
        for (const double mass : rest.masses) lightest = std::min(lightest, mass);
        ElementForces forces{sides = std::make_shared<SideForces>(rest, damping)};
        if (everything) {
            CreaseLaw law;
            law.bending = 30. * in.young * std::pow(in.thickness, 3) / 12.;
            forces.push_back(creases = std::make_shared<CreaseForce>(rest, law));
            forces.push_back(drag = std::make_shared<DragForce>(triangles, 1.2e-3));
        }
        sweep.prepare(forces, rest.masses, std::vector<char>(rest.masses.size(), true), 1);
        shapes::Random random(7);
        for (std::size_t i = 0; i < in.nodes.size(); ++i) {
            sweep.x.set(i, in.nodes[i] + random.vector(perturbation));
            sweep.v.set(i, random.vector(perturbation));
            sweep.u.set(i, sweep.v.at(i));
        }
        step.dt = 0.1 * std::sqrt(lightest / stiffest);
    }

    /// \return whether all nodes stayed in finite places
    bool run(int steps) {
        bool finite = true;
        for (int i = 0; i < steps; ++i) finite = sweep.step(step) && finite;
        return finite;
    }
};

/// Bytes that tell which nodes each block's elements have; a run needs only the first.
template <class Force> double indexBytes(const std::shared_ptr<Force>& force) {
    double bytes = 0.;
    if (!force) return bytes;
    const auto& order = force->order();
    const std::size_t K = order.node.size();
    for (const Block& block : order.blocks)
        bytes += sizeof(Block) + K * sizeof(int) * (block.run ? 1 : static_cast<std::size_t>(block.count()));
    return bytes;
}

/// Elements that are computed, padding included.
template <class Force> int computed(const std::shared_ptr<Force>& force) {
    int count = 0;
    if (force)
        for (const Block& block : force->order().blocks) count += block.paddedCount();
    return count;
}

int sheet(int side, bool everything, int warm, int steps) {
    Model model(side, everything);
    CALLGRIND_START_INSTRUMENTATION;
    bool finite = model.run(warm);
    CALLGRIND_ZERO_STATS;
    const double start = now();
    finite = model.run(steps) && finite;
    const double seconds = now() - start;
    CALLGRIND_STOP_INSTRUMENTATION;
    if (!finite) {
        std::fprintf(stderr, "roofline: the sheet did not stay finite\n");
        return 1;
    }

    const std::size_t nodes = model.rest.masses.size();
    const std::size_t creases = model.creases ? model.creases->order().size() : 0;
    // Read once: indices, constants, masses. Read and written once: x, v, u, forces; weights of drag.
    const double read = indexBytes(model.sides) + indexBytes(model.creases) + indexBytes(model.drag) +
                        sizeof(double) * (4. * model.sides->constantCount() + 7. * creases + nodes);
    const double both = sizeof(double) * (12. + everything) * nodes;
    std::printf("{\"nodes\": %zu, \"sides\": %zu, \"creases\": %zu, \"triangles\": %zu, \"computed\": {\"nodes\": %zu, "
                "\"sides\": %d, \"creases\": %d, \"triangles\": %d}, \"held\": %.0f, \"moved\": %.0f, \"steps\": %d, "
                "\"seconds\": %.9g}\n",
                nodes, model.rest.sides.size(), model.rest.creases.size(), everything ? model.triangles.size() : 0,
                nodes, computed(model.sides), computed(model.creases), computed(model.drag), read + both,
                read + 2. * both, steps, seconds / steps);
    return 0;
}

// ---------------------------------------------------------------------------------------------------------------------
// The machine's limits. Of each the best of a few attempts counts.

using Vector = double __attribute__((vector_size(32)));
constexpr int attempts = 5;

/// Least time [s] that `work` takes.
template <class Work> double leastTime(const Work& work) {
    double least = 0.;
    for (int attempt = 0; attempt < attempts; ++attempt) {
        const double start = now();
        work();
        const double taken = now() - start;
        if (attempt == 0 || taken < least) least = taken;
    }
    return least;
}

/// Keeps the compiler from knowing a value, and from leaving out what it does not need.
template <class Value> void hide(Value& value) {
    asm volatile("" : "+x"(value));
}

/// STREAM's triad onto one of its operands: like the kernels it writes no line that it has not read.
MEMBRANE_VECTORISED void triad(double* a, const double* b, double factor, std::size_t count) {
#pragma GCC ivdep
    for (std::size_t i = 0; i < count; ++i) a[i] += factor * b[i];
}

/// Bytes a second that a triad over two arrays of `bytes` together reads and writes.
double bandwidth(std::size_t bytes) {
    const std::size_t count = bytes / (2 * sizeof(double));
    const std::size_t times = std::max<std::size_t>(1, (std::size_t(1) << 30) / bytes);
    Array a(count, 1.), b(count, 1.);
    const double seconds = leastTime([&] {
        for (std::size_t i = 0; i < times; ++i) triad(a.data(), b.data(), 1e-9, count);
    });
    return 3. * sizeof(double) * static_cast<double>(count * times) / seconds;
}

constexpr long rounds = 20'000'000;
constexpr int width = sizeof(Vector) / sizeof(double);

// Independent chains of 256-bit vectors: as many as hide the latency and still fit into the 16 registers.

/// Sums and products side by side, as the kernels are built: without fused multiply-add. \return flops
__attribute__((target("avx2,no-fma"), noinline)) double sumsAndProducts() {
    constexpr int chains = 6;
    Vector sum[chains] = {}, product[chains], term = _mm256_set1_pd(1e-9), factor = _mm256_set1_pd(1. + 1e-15);
    for (Vector& p : product) p = _mm256_set1_pd(1.);
    for (int k = 0; k < chains; ++k) hide(sum[k]), hide(product[k]);
    hide(term), hide(factor);
    for (long i = 0; i < rounds; ++i) {
#pragma GCC unroll 6
        for (int k = 0; k < chains; ++k) {
            sum[k] += term;
            product[k] *= factor;
        }
    }
    for (int k = 0; k < chains; ++k) hide(sum[k]), hide(product[k]);
    return 2. * chains * width * rounds;
}

/// Fused multiply-adds, each counted as two. \return flops
__attribute__((target("avx2,fma"), noinline)) double multiplyAdds() {
    constexpr int chains = 12;
    Vector value[chains] = {}, term = _mm256_set1_pd(1e-9), factor = _mm256_set1_pd(0.5);
    for (Vector& v : value) hide(v);
    hide(term), hide(factor);
    for (long i = 0; i < rounds; ++i) {
#pragma GCC unroll 12
        for (int k = 0; k < chains; ++k) value[k] = _mm256_fmadd_pd(value[k], factor, term);
    }
    for (Vector& v : value) hide(v);
    return 2. * chains * width * rounds;
}

/// Divisions, or else square roots. \return how many
template <bool root> __attribute__((target("avx2"), noinline)) double rootsOrDivisions() {
    constexpr int chains = 8;
    Vector value[chains], term = _mm256_set1_pd(1.3);
    for (Vector& v : value) {
        v = _mm256_set1_pd(1.7);
        hide(v);
    }
    hide(term);
    for (long i = 0; i < rounds / 10; ++i) {
#pragma GCC unroll 8
        for (int k = 0; k < chains; ++k) value[k] = root ? _mm256_sqrt_pd(value[k]) : term / value[k];
    }
    for (Vector& v : value) hide(v);
    return static_cast<double>(chains * width * (rounds / 10));
}

/// Products that wait for the one before them, three cycles in all CPUs with 256-bit vectors. \return cycles
double waitingProducts() {
    unsigned long value = 3;
    for (long i = 0; i < rounds; ++i) asm volatile("imul %0, %0" : "+r"(value));
    return 3. * rounds;
}

/// What a function does in a second.
double rate(double (*work)()) {
    double done = 0.;
    const double seconds = leastTime([&] { done = work(); });
    return done / seconds;
}

int limits(int count, char** bytes) {
    std::printf("{\"peak\": %.9g, \"fused\": %.9g, \"divisions\": %.9g, \"roots\": %.9g, \"clock\": %.9g, ",
                rate(sumsAndProducts), rate(multiplyAdds), rate(rootsOrDivisions<false>), rate(rootsOrDivisions<true>),
                rate(waitingProducts));
    std::printf("\"bandwidth\": [");
    for (int i = 0; i < count; ++i) std::printf("%s%.9g", i ? ", " : "", bandwidth(std::stoul(bytes[i])));
    std::printf("]}\n");
    return 0;
}

} // namespace

int main(int count, char** arguments) {
    const std::string what = count > 1 ? arguments[1] : "";
    const auto number = [arguments](int i) { return std::stoi(arguments[i]); };
    if (what == "sheet" && count == 6) return sheet(number(2), number(3) != 0, number(4), number(5));
    if (what == "limits" && count > 2) return limits(count - 2, arguments + 2);
    std::fprintf(stderr, "usage: roofline sheet NODES_ALONG_AN_EDGE ALL_FORCES(0|1) WARMING_STEPS STEPS\n"
                         "       roofline limits BYTES...\n");
    return 2;
}
