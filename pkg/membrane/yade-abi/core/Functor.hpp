// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Timing.hpp>
#include <lib/multimethods/FunctorWrapper.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

class Scene;

class Functor : public Serializable {
public:
    virtual vector<string> getFunctorTypes() const;
    shared_ptr<TimingDeltas> timingDeltas;
    // set by the dispatcher before every loop
    Scene* scene;
    virtual ~Functor();

    string label;

    Functor() : scene(nullptr) {}
    YADE_ABI_SERIALIZABLE
};

YADE_ABI_LAYOUT(Functor, 80, ((timingDeltas, 24))((scene, 40))((label, 48)));
YADE_ABI_SAVED(Functor)

template <class Type1, class Result, class Arguments>
class Functor1D : public Functor, public FunctorWrapper<Result, Arguments> {
public:
    using DispatchType1 = Type1;
    using ReturnType = Result;
    using ArgumentTypes = Arguments;
    using Calls = FunctorWrapper<Result, Arguments>;

    virtual string get1DFunctorType1() const;
    vector<string> getFunctorTypes() const override;
    string getBaseClassName(unsigned int i = 0) const override;
    int getBaseClassNumber() const override;
    string getClassName() const override;
    virtual ~Functor1D();
};

template <class Type1, class Type2, class Result, class Arguments>
class Functor2D : public Functor, public FunctorWrapper<Result, Arguments> {
public:
    using DispatchType1 = Type1;
    using DispatchType2 = Type2;
    using ReturnType = Result;
    using ArgumentTypes = Arguments;
    using Calls = FunctorWrapper<Result, Arguments>;

    virtual string get2DFunctorType1() const;
    virtual string get2DFunctorType2() const;
    vector<string> getFunctorTypes() const override;
    string getBaseClassName(unsigned int i = 0) const override;
    int getBaseClassNumber() const override;
    string getClassName() const override;
    virtual ~Functor2D();
};

} // namespace yade

// The types a functor accepts. The calls it does not override stay visible beside the one it does.
#define FUNCTOR1D(Type1)                                                                                               \
public:                                                                                                                \
    using Calls::go;                                                                                                   \
    ::std::string get1DFunctorType1() const override {                                                                 \
        return #Type1;                                                                                                 \
    }
#define FUNCTOR2D(Type1, Type2)                                                                                        \
public:                                                                                                                \
    using Calls::go;                                                                                                   \
    using Calls::goReverse;                                                                                            \
    ::std::string get2DFunctorType1() const override {                                                                 \
        return #Type1;                                                                                                 \
    }                                                                                                                  \
    ::std::string get2DFunctorType2() const override {                                                                 \
        return #Type2;                                                                                                 \
    }
