// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lib/serialization/Serializable.hpp>

#include <boost/mpl/at.hpp>
#include <boost/mpl/vector.hpp>

namespace yade {

// The calls of a functor, for 1 to 7 arguments; parameters beyond the list are boost::mpl::void_. A functor overrides
// the one of its own length. The bodies that complain about a missing override are in the libraries.
template <class Result, class Arguments> class FunctorWrapper {
    template <int i> using P = typename boost::mpl::at_c<Arguments, i>::type;

public:
    FunctorWrapper() {}
    virtual ~FunctorWrapper() {}
    virtual string checkOrder() const;

    virtual Result go(P<0>);
    virtual Result go(P<0>, P<1>);
    virtual Result go(P<0>, P<1>, P<2>);
    virtual Result go(P<0>, P<1>, P<2>, P<3>);
    virtual Result go(P<0>, P<1>, P<2>, P<3>, P<4>);
    virtual Result go(P<0>, P<1>, P<2>, P<3>, P<4>, P<5>);
    virtual Result go(P<0>, P<1>, P<2>, P<3>, P<4>, P<5>, P<6>);

    virtual Result goReverse(P<0>);
    virtual Result goReverse(P<0>, P<1>);
    virtual Result goReverse(P<0>, P<1>, P<2>);
    virtual Result goReverse(P<0>, P<1>, P<2>, P<3>);
    virtual Result goReverse(P<0>, P<1>, P<2>, P<3>, P<4>);
    virtual Result goReverse(P<0>, P<1>, P<2>, P<3>, P<4>, P<5>);
    virtual Result goReverse(P<0>, P<1>, P<2>, P<3>, P<4>, P<5>, P<6>);
};

} // namespace yade

// Asked for by dispatchers that may not swap the two arguments, such as the one for IGeomFunctor.
#define DEFINE_FUNCTOR_ORDER_2D(Type1, Type2)                                                                          \
public:                                                                                                                \
    ::std::string checkOrder() const override {                                                                        \
        return #Type1 " " #Type2;                                                                                      \
    }
