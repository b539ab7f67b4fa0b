// What IDA and KINSOL of SUNDIALS share here: handles, and a direct linear solver of ours in place of theirs.
// For ida.cpp and kinsol.cpp only. Its libraries are not linked: what calls them first loads them.
#pragma once

#include <dlfcn.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

#include <atomic>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <type_traits>

#include "libmbd/core/error.hpp"
#include "libmbd/core/types.hpp"

namespace mbd::sundials {

// A function of a shared library, which is loaded, and stays, when one of its functions is first called. Throws Error then where
// it cannot be.
template <class F>
class Loaded;
template <class R, class... A>
class Loaded<R(A...)> {
 public:
  constexpr Loaded(const char* library, const char* name) : library_(library), name_(name) {}
  R operator()(A... arguments) const {
    R (*function)(A...) = function_.load(std::memory_order_acquire);
    if (function == nullptr) {
      void* const library = dlopen(library_, RTLD_NOW | RTLD_LOCAL);
      void* const found = library == nullptr ? nullptr : dlsym(library, name_);
      if (found == nullptr) {
        const char* const why = dlerror();
        throw Error(std::string("SUNDIALS cannot be loaded (") + (why ? why : library_) +
                    "); install libsundials-ida6, -kinsol6 and -nvecserial6 (Debian)");
      }
      function = reinterpret_cast<R (*)(A...)>(found);
      function_.store(function, std::memory_order_release);
    }
    return function(arguments...);
  }

 private:
  const char* library_;
  const char* name_;
  mutable std::atomic<R (*)(A...)> function_{nullptr};
};

// Named as the function is, in a namespace of ours, it takes its place there.
#define MBD_LOADED(library, name) \
  constinit const ::mbd::sundials::Loaded<decltype(::name)> name { library, #name }

inline MBD_LOADED(MBD_SUNDIALS_NVECTOR, SUNContext_Create);
inline MBD_LOADED(MBD_SUNDIALS_NVECTOR, SUNContext_Free);
inline MBD_LOADED(MBD_SUNDIALS_NVECTOR, N_VNew_Serial);
inline MBD_LOADED(MBD_SUNDIALS_NVECTOR, N_VConst);
inline MBD_LOADED(MBD_SUNDIALS_NVECTOR, N_VDestroy);
inline MBD_LOADED(MBD_SUNDIALS_NVECTOR, SUNMatNewEmpty);
inline MBD_LOADED(MBD_SUNDIALS_NVECTOR, SUNMatFreeEmpty);
inline MBD_LOADED(MBD_SUNDIALS_NVECTOR, SUNLinSolNewEmpty);
inline MBD_LOADED(MBD_SUNDIALS_NVECTOR, SUNLinSolFreeEmpty);

struct Deleter {
  void operator()(SUNContext context) const { SUNContext_Free(&context); }
  void operator()(N_Vector v) const { N_VDestroy(v); }
  void operator()(SUNMatrix A) const { SUNMatFreeEmpty(A); }
  void operator()(SUNLinearSolver S) const { SUNLinSolFreeEmpty(S); }
};
template <class T>
using Handle = std::unique_ptr<std::remove_pointer_t<T>, Deleter>;
using Context = Handle<SUNContext>;  // has to outlive what it made
using Vector = Handle<N_Vector>;

inline Context make_context() {
  SUNContext context = nullptr;
  if (SUNContext_Create(nullptr, &context) != 0) throw std::bad_alloc();
  return Context(context);
}

inline Vector make_vector(Index size, const Context& context) {
  Vector v(N_VNew_Serial(size, context.get()));
  if (!v) throw std::bad_alloc();
  N_VConst(0.0, v.get());
  return v;
}

inline std::span<double> values(N_Vector v) {
  return {NV_DATA_S(v), static_cast<std::size_t>(NV_LENGTH_S(v))};
}

// A linear solver whose work `owner` does: factor(), and solve(x, b) for vectors, which return 0, or more to be
// asked again with a shorter step. SUNDIALS wants a matrix beside it: an empty one.
struct OwnSolver {
  Handle<SUNMatrix> matrix;
  Handle<SUNLinearSolver> solver;

  template <class Owner>
  OwnSolver(Owner& owner, const Context& context)
      : matrix(SUNMatNewEmpty(context.get())), solver(SUNLinSolNewEmpty(context.get())) {
    if (!matrix || !solver) throw std::bad_alloc();
    matrix->ops->getid = [](SUNMatrix) { return SUNMATRIX_CUSTOM; };
    matrix->ops->zero = [](SUNMatrix) { return 0; };
    solver->content = &owner;
    solver->ops->gettype = [](SUNLinearSolver) { return SUNLINEARSOLVER_DIRECT; };
    solver->ops->setup = [](SUNLinearSolver S, SUNMatrix) {
      return static_cast<Owner*>(S->content)->factor();
    };
    solver->ops->solve = [](SUNLinearSolver S, SUNMatrix, N_Vector x, N_Vector b, realtype) {
      return static_cast<Owner*>(S->content)->solve(x, b);
    };
  }
};

}  // namespace mbd::sundials
