// Factorises and solves a sparse symmetric system with CHOLMOD or Eigen: `direct METHOD FILE`.
//
// FILE holds, in the byte order of the machine, the number of rows n and of entries (64-bit), the
// starts of the n columns and the row of each entry (32-bit), the values, and three right-hand
// sides one after another (doubles). The solutions go to FILE.out. Prints one JSON object.
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCholesky>

extern "C" char *openblas_get_config() __attribute__((weak));

using Matrix = Eigen::SparseMatrix<double>;

static double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

template <class Solver>
static int run(Solver &solver, const Matrix &a, const Eigen::MatrixXd &b, const std::string &path) {
    double start = now();
    solver.compute(a);
    double factor = now() - start;
    if (solver.info() != Eigen::Success) {
        std::cerr << "the factorisation failed\n";
        return 1;
    }
    start = now();
    Eigen::MatrixXd x = solver.solve(b);
    double solve = now() - start;
    std::ofstream out(path + ".out", std::ios::binary);
    out.write(reinterpret_cast<const char *>(x.data()), x.size() * sizeof(double));
    const char *blas = openblas_get_config ? openblas_get_config() : "unknown";
    printf("{\"factor\": %.6f, \"solve\": %.6f, \"eigen\": \"%d.%d.%d\", \"cholmod\": \"%d.%d.%d\", \"blas\": \"%s\"}\n",
           factor, solve, EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION, CHOLMOD_MAIN_VERSION,
           CHOLMOD_SUB_VERSION, CHOLMOD_SUBSUB_VERSION, blas);
    return 0;
}

int main(int argc, char **argv) {
    if (argc != 3) {
        std::cerr << "usage: direct METHOD FILE\n";
        return 2;
    }
    std::string method = argv[1], path = argv[2];
    std::ifstream in(path, std::ios::binary);
    std::int64_t n = 0, entries = 0;
    in.read(reinterpret_cast<char *>(&n), 8).read(reinterpret_cast<char *>(&entries), 8);
    Matrix a(n, n);
    a.makeCompressed();
    a.resizeNonZeros(entries);
    in.read(reinterpret_cast<char *>(a.outerIndexPtr()), (n + 1) * 4);
    in.read(reinterpret_cast<char *>(a.innerIndexPtr()), entries * 4);
    in.read(reinterpret_cast<char *>(a.valuePtr()), entries * 8);
    Eigen::MatrixXd b(n, 3);
    in.read(reinterpret_cast<char *>(b.data()), b.size() * 8);
    if (!in) {
        std::cerr << "cannot read " << path << "\n";
        return 1;
    }
    if (method == "eigen-ldlt") {
        Eigen::SimplicialLDLT<Matrix> solver;
        return run(solver, a, b, path);
    }
    Eigen::CholmodSupernodalLLT<Matrix> solver;
    if (method == "cholmod-amd" || method == "cholmod-metis") {
        solver.cholmod().nmethods = 1;
        solver.cholmod().method[0].ordering = method == "cholmod-amd" ? CHOLMOD_AMD : CHOLMOD_METIS;
    } else if (method != "cholmod") {
        std::cerr << "there is no method " << method << "\n";
        return 2;
    }
    return run(solver, a, b, path);
}
