// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lib/factory/ClassFactory.hpp>

#include <boost/enable_shared_from_this.hpp>
#include <sstream>

namespace yade {

class Factorable : public boost::enable_shared_from_this<Factorable> {
public:
    Factorable() {}
    virtual ~Factorable();
    virtual string getBaseClassName(unsigned int i = 0) const;
    virtual int getBaseClassNumber() const;
    virtual string getClassName() const;
};

YADE_ABI_LAYOUT(Factorable, 24, );

namespace abi {
inline vector<string> words(const char* text) {
    std::istringstream in(text);
    vector<string> ret;
    for (string word; in >> word;) ret.push_back(word);
    return ret;
}
} // namespace abi

} // namespace yade

// bases: one name, or several with blanks between
#define REGISTER_CLASS_AND_BASE(Class, bases) REGISTER_CLASS_NAME(Class) REGISTER_BASE_CLASS_NAME(bases)
#define REGISTER_CLASS_NAME(Class)                                                                                     \
public:                                                                                                                \
    ::std::string getClassName() const override {                                                                      \
        return #Class;                                                                                                 \
    }
#define REGISTER_BASE_CLASS_NAME(bases)                                                                                \
public:                                                                                                                \
    ::std::string getBaseClassName(unsigned int i = 0) const override {                                                \
        const auto names = ::yade::abi::words(#bases);                                                                 \
        return i < names.size() ? names[i] : ::std::string();                                                          \
    }                                                                                                                  \
    int getBaseClassNumber() const override {                                                                          \
        return int(::yade::abi::words(#bases).size());                                                                 \
    }
