// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// Macros with which the headers in core/ and pkg/ declare classes that live in YADE's libraries. Nothing they declare
// gets a body here, so that vtable, typeinfo and code are the ones in the libraries.

#include <abi/Archives.hpp>

#include <boost/python/dict.hpp>
#include <boost/python/object.hpp>
#include <boost/python/tuple.hpp>

// What YADE generates for every class, minus the Python registration.
#define YADE_ABI_ATTRIBUTES                                                                                            \
public:                                                                                                                \
    std::string getBaseClassName(unsigned int = 0) const override;                                                     \
    int getBaseClassNumber() const override;                                                                           \
    std::string getClassName() const override;                                                                         \
    void pySetAttr(const std::string&, const ::boost::python::object&) override;                                       \
    ::boost::python::dict pyDict() const override;                                                                     \
    void callPostLoad() override;                                                                                      \
                                                                                                                       \
private:                                                                                                               \
    friend class ::boost::serialization::access;                                                                       \
    template <class Archive> void serialize(Archive&, unsigned int);                                                   \
                                                                                                                       \
public:

#define YADE_ABI_SERIALIZABLE                                                                                          \
    YADE_ABI_ATTRIBUTES                                                                                                \
    void pyRegisterClass(::boost::python::object) override;

// A class below one of the tops of dispatch, such as FrictMat.
#define YADE_ABI_INDEXABLE                                                                                             \
protected:                                                                                                             \
    int& modifyClassIndex() override;                                                                                  \
                                                                                                                       \
public:                                                                                                                \
    const int& getClassIndex() const override;                                                                         \
    const int& getBaseClassIndex(int) const override;

// A top of dispatch, such as Material; its vtable has these five functions in this order.
#define YADE_ABI_TOP_INDEXABLE                                                                                         \
    YADE_ABI_INDEXABLE                                                                                                 \
    const int& getMaxCurrentlyUsedClassIndexOfKin() const override;                                                    \
                                                                                                                       \
protected:                                                                                                             \
    void incrementMaxCurrentlyUsedClassIndexOfKin() override;                                                          \
                                                                                                                       \
public:

// After the class, in namespace yade: its name in saved files, and the library's functions that save and load it.
#define YADE_ABI_SAVED(Class)                                                                                          \
    }                                                                                                                  \
    BOOST_CLASS_EXPORT_KEY(yade::Class)                                                                                \
    namespace boost {                                                                                                  \
    namespace archive {                                                                                                \
    namespace detail {                                                                                                 \
    extern template void oserializer<xml_oarchive, yade::Class>::save_object_data(basic_oarchive&, const void*) const; \
    extern template void oserializer<binary_oarchive, yade::Class>::save_object_data(basic_oarchive&,                  \
                                                                                     const void*) const;               \
    extern template void iserializer<xml_iarchive, yade::Class>::load_object_data(basic_iarchive&, void*,              \
                                                                                  unsigned int) const;                 \
    extern template void iserializer<binary_iarchive, yade::Class>::load_object_data(basic_iarchive&, void*,           \
                                                                                     unsigned int) const;              \
    }                                                                                                                  \
    }                                                                                                                  \
    }                                                                                                                  \
    namespace yade {
