// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <boost/shared_ptr.hpp>
#include <typeinfo>

namespace yade {

/// The object as one of a class that nothing derives from, or null: a dynamic_cast takes longer than a side's force.
template <class Class, class Base> Class* exactly(const boost::shared_ptr<Base>& object) {
    Base* const base = object.get();
    return base && typeid(*base) == typeid(Class) ? static_cast<Class*>(base) : nullptr;
}

} // namespace yade
