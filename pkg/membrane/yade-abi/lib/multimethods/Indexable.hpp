// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <abi/Abi.hpp>

#include <boost/scoped_ptr.hpp>
#include <stdexcept>

namespace yade {

// Numbers the classes below a top of dispatch. Not one function of it is in the libraries, hence the bodies.
class Indexable {
protected:
    void createIndex() {
        int& index = modifyClassIndex();
        if (index >= 0) return;
        incrementMaxCurrentlyUsedClassIndexOfKin();
        index = getMaxCurrentlyUsedClassIndexOfKin();
    }
    virtual void incrementMaxCurrentlyUsedClassIndexOfKin() { notOverridden(); }
    virtual int& modifyClassIndex() { notOverridden(); }

public:
    Indexable() {}
    virtual ~Indexable() = default;
    virtual const int& getClassIndex() const { notOverridden(); }
    virtual const int& getBaseClassIndex(int) const { notOverridden(); }
    virtual const int& getMaxCurrentlyUsedClassIndexOfKin() const { notOverridden(); }

private:
    [[noreturn]] static void notOverridden() { throw std::logic_error("Indexable: REGISTER_CLASS_INDEX is missing."); }
};

YADE_ABI_LAYOUT(Indexable, 8, );

} // namespace yade

// In the class, with createIndex() in its constructor. depth counts upwards: 1 is Base.
#define REGISTER_CLASS_INDEX(Class, Base)                                                                              \
private:                                                                                                               \
    static int& modifyClassIndexStatic() {                                                                             \
        static int index = -1;                                                                                         \
        return index;                                                                                                  \
    }                                                                                                                  \
                                                                                                                       \
protected:                                                                                                             \
    int& modifyClassIndex() override {                                                                                 \
        return modifyClassIndexStatic();                                                                               \
    }                                                                                                                  \
                                                                                                                       \
public:                                                                                                                \
    static const int& getClassIndexStatic() {                                                                          \
        return modifyClassIndexStatic();                                                                               \
    }                                                                                                                  \
    const int& getClassIndex() const override {                                                                        \
        return getClassIndexStatic();                                                                                  \
    }                                                                                                                  \
    const int& getBaseClassIndex(int depth) const override {                                                           \
        static const ::boost::scoped_ptr<Base> base(new Base);                                                         \
        return depth > 1 ? base->getBaseClassIndex(depth - 1) : base->getClassIndex();                                 \
    }
