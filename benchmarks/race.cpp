// Runs every candidate in one process, block by block in turn, and writes nanoseconds per call: one line per block.
//
//   race ARM BLOCKS "NAME|KIND|TARGET|WIDTH|FILE|ENTRY|INPUTS"...
//
// KIND own: TARGET is a library with run(in, out); casadi: one with CasADi's ENTRY of INPUTS arguments; pinocchio: the
// name of an algorithm. The first line holds, per candidate, the sum over the inputs of its first result: whoever does
// the same task must have the same. FILE holds the inputs as doubles, WIDTH per call.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#if __has_include(<pinocchio/multibody.hpp>)
#include <pinocchio/multibody.hpp>
#else
#include <pinocchio/multibody/data.hpp>
#include <pinocchio/multibody/model.hpp>
#endif
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>

namespace pin = pinocchio;
using Vector = Eigen::VectorXd;

static std::vector<double> read_doubles(const std::string &path)
{
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    std::vector<double> values(static_cast<std::size_t>(file.tellg()) / sizeof(double));
    file.seekg(0);
    file.read(reinterpret_cast<char *>(values.data()), static_cast<std::streamsize>(values.size() * sizeof(double)));
    return values;
}

// joints turn about their own z; per joint: placement (16, row by row), mass, centre of mass (3), tensor (9)
static pin::Model read_arm(const std::string &path)
{
    std::vector<double> v = read_doubles(path);
    pin::Model model;
    pin::JointIndex joint = 0;
    for (std::size_t k = 0; k + 29 <= v.size(); k += 29) {
        Eigen::Matrix4d X = Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(&v[k]);
        Eigen::Matrix3d I = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&v[k + 20]);
        joint = model.addJoint(joint, pin::JointModelRZ(), pin::SE3(X), "joint" + std::to_string(k));
        model.appendBodyToJoint(joint, pin::Inertia(v[k + 16], Eigen::Vector3d(v[k + 17], v[k + 18], v[k + 19]), I));
    }
    model.gravity.linear(Eigen::Vector3d(0, 0, -9.81));
    return model;
}

struct Candidate {
    std::string name;
    std::size_t width;
    std::vector<double> inputs;
    std::function<double(const double *)> call;
    std::size_t count() const { return inputs.size() / width; }
};

using Run = void (*)(const double *, double *);
using CasadiFunction = int (*)(const double **, double **, long long *, double *, int);
using CasadiWork = int (*)(long long *, long long *, long long *, long long *);

static void *symbol(const std::string &library, const char *name)
{
    void *handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    void *found = handle ? dlsym(handle, name) : nullptr;
    if (!found) { std::cerr << dlerror() << "\n"; std::exit(1); }
    return found;
}

static std::function<double(const double *)> pinocchio_call(const std::string &kind, const std::string &arm)
{
    auto model = std::make_shared<pin::Model>(read_arm(arm));
    auto data = std::make_shared<pin::Data>(*model);
    using Map = Eigen::Map<const Vector>;
    if (kind == "rnea")
        return [=](const double *x) { return pin::rnea(*model, *data, Map(x, 6), Map(x + 6, 6), Map(x + 12, 6))[0]; };
    if (kind == "crba")
        return [=](const double *x) { return pin::crba(*model, *data, Map(x, 6), pin::Convention::WORLD)(0, 0); };
    if (kind == "aba")
        return [=](const double *x) {
            return pin::aba(*model, *data, Map(x, 6), Map(x + 6, 6), Map(x + 12, 6), pin::Convention::WORLD)[0];
        };
    if (kind == "aba_local")
        return [=](const double *x) {
            return pin::aba(*model, *data, Map(x, 6), Map(x + 6, 6), Map(x + 12, 6), pin::Convention::LOCAL)[0];
        };
    return [=](const double *x) {
        pin::computeABADerivatives(*model, *data, Map(x, 6), Map(x + 6, 6), Map(x + 12, 6));
        return data->ddq[0];
    };
}

int main(int argc, char **argv)
{
    const std::string arm = argv[1];
    const int blocks = std::atoi(argv[2]);
    std::vector<Candidate> candidates;
    for (int k = 3; k < argc; k++) {
        std::vector<std::string> words;
        std::stringstream stream(argv[k]);
        for (std::string word; std::getline(stream, word, '|');) { words.push_back(word); }
        Candidate c{words[0], std::stoul(words[3]), read_doubles(words[4]), {}};
        if (words[1] == "own") {
            auto run = reinterpret_cast<Run>(symbol(words[2], "run"));
            c.call = [run](const double *x) { static double out[256]; run(x, out); return out[0]; };
        } else if (words[1] == "casadi") {
            const std::string entry = words[5];
            auto f = reinterpret_cast<CasadiFunction>(symbol(words[2], entry.c_str()));
            auto sizes = reinterpret_cast<CasadiWork>(symbol(words[2], (entry + "_work").c_str()));
            long long n[4];
            sizes(&n[0], &n[1], &n[2], &n[3]);
            auto work = std::make_shared<std::vector<double>>(static_cast<std::size_t>(n[3]) + 1);
            auto iw = std::make_shared<std::vector<long long>>(static_cast<std::size_t>(n[2]) + 1);
            const std::size_t inputs = std::stoul(words[6]);
            c.call = [f, work, iw, inputs](const double *x) {
                static double out[256];
                const double *arg[32];
                double *res[32] = {out, out + 36, out + 72, out + 108};
                for (std::size_t i = 0; i < inputs; i++) { arg[i] = x + 6 * i; }
                f(arg, res, iw->data(), work->data(), 0);
                return out[0];
            };
        } else {
            c.call = pinocchio_call(words[2], arm);
        }
        candidates.push_back(c);
    }
    std::printf("sums");
    for (auto &c : candidates) {
        double total = 0.0;
        for (std::size_t i = 0; i < c.count(); i++) { total += c.call(&c.inputs[i * c.width]); }
        std::printf(" %.17g", total);
    }
    std::printf("\n");
    double sum = 0.0;
    for (int b = -2; b < blocks; b++) {
        for (auto &c : candidates) {
            const auto start = std::chrono::steady_clock::now();
            for (int repeat = 0; repeat < 8; repeat++)
                for (std::size_t i = 0; i < c.count(); i++) { sum += c.call(&c.inputs[i * c.width]); }
            const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
            if (b >= 0) { std::printf("%s%.3f", &c == &candidates[0] ? "" : " ", time.count() / (8.0 * c.count())); }
        }
        if (b >= 0) { std::printf("\n"); }
    }
    std::fprintf(stderr, "%g\n", sum);
    return 0;
}
