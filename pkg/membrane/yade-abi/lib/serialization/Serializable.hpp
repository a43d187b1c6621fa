// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <abi/Attributes.hpp>

namespace yade {

namespace py = ::boost::python;

class Serializable : public Factorable {
public:
    Serializable() {}
    virtual ~Serializable();

    template <class Archive> void serialize(Archive&, unsigned int) {}
    template <class Derived> const Derived& cast() const { return *static_cast<const Derived*>(this); }
    template <class Derived> Derived& cast() { return *static_cast<Derived*>(this); }

    // identity, not equality of attributes
    bool operator==(const Serializable& s) { return &s == this; }
    bool operator!=(const Serializable& s) { return !(*this == s); }

    void pyUpdateAttrs(const ::boost::python::dict&);
    string pyStr();

    virtual void pySetAttr(const string& key, const ::boost::python::object& value);
    virtual ::boost::python::dict pyDict() const;
    virtual ::boost::python::dict pyDictCustom() const;
    virtual void callPostLoad();
    virtual void checkPyClassRegistersItself(const string& name) const;
    virtual void pyRegisterClass(::boost::python::object scope);
    // may take what it likes out of a Python constructor's arguments
    virtual void pyHandleCustomCtorArgs(::boost::python::tuple& args, ::boost::python::dict& keywords);

    string getBaseClassName(unsigned int i = 0) const override;
    int getBaseClassNumber() const override;
    string getClassName() const override;
};

YADE_ABI_LAYOUT(Serializable, 24, );

} // namespace yade

#include <abi/Declare.hpp>

namespace yade {
YADE_ABI_SAVED(Serializable)
}

// In namespace yade, after the class: registers it with the factory and names it `yade::Class` in saved files.
#define REGISTER_SERIALIZABLE(Class)                                                                                   \
    REGISTER_FACTORABLE(Class)                                                                                         \
    }                                                                                                                  \
    BOOST_CLASS_EXPORT_KEY(yade::Class)                                                                                \
    namespace yade {

// Inside a class. attrs: sequence of tuples (type, name, default, flags, "doc"). inits: sequence of pairs (member,
// value) for the constructor. ctor: its statements. py: calls of the Python class, as in .def("f", &Class::f).
#define YADE_CLASS_BASE_DOC(Class, Base, doc) YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(Class, Base, doc, , , , )
#define YADE_CLASS_BASE_DOC_ATTRS(Class, Base, doc, attrs)                                                             \
    YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(Class, Base, doc, attrs, , , )
#define YADE_CLASS_BASE_DOC_ATTRS_CTOR(Class, Base, doc, attrs, ctor)                                                  \
    YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(Class, Base, doc, attrs, , ctor, )
#define YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(Class, Base, doc, attrs, ctor, py)                                           \
    YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(Class, Base, doc, attrs, , ctor, py)

#define YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(Class, Base, doc, attrs, inits, ctor, py)                               \
public:                                                                                                                \
    BOOST_PP_SEQ_FOR_EACH(YADE_ABI_DECLARE, ~, attrs)                                                                  \
    Class() YADE_ABI_INITIALIZERS(YADE_ABI_ALL_INITIALIZERS(inits, attrs)) {                                           \
        ctor;                                                                                                          \
    }                                                                                                                  \
                                                                                                                       \
private:                                                                                                               \
    friend class ::boost::serialization::access;                                                                       \
    template <class Archive> void serialize(Archive& archive, unsigned int) {                                          \
        archive& ::boost::serialization::make_nvp(#Base, ::boost::serialization::base_object<Base>(*this));            \
        if (Archive::is_loading::value)                                                                                \
            preLoad(*this);                                                                                            \
        else                                                                                                           \
            preSave(*this);                                                                                            \
        BOOST_PP_SEQ_FOR_EACH(YADE_ABI_SAVE, archive, attrs)                                                           \
        if (Archive::is_loading::value)                                                                                \
            postLoad(*this);                                                                                           \
        else                                                                                                           \
            postSave(*this);                                                                                           \
    }                                                                                                                  \
                                                                                                                       \
public:                                                                                                                \
    REGISTER_CLASS_AND_BASE(Class, Base)                                                                               \
    void pySetAttr(const ::std::string& key, const ::boost::python::object& value) override {                          \
        BOOST_PP_SEQ_FOR_EACH(YADE_ABI_SET, ~, attrs)                                                                  \
        Base::pySetAttr(key, value);                                                                                   \
    }                                                                                                                  \
    ::boost::python::dict pyDict() const override {                                                                    \
        const ::yade::abi::Access access;                                                                              \
        ::boost::python::dict ret;                                                                                     \
        BOOST_PP_SEQ_FOR_EACH(YADE_ABI_TO_DICT, ret, attrs)                                                            \
        ret.update(this->pyDictCustom());                                                                              \
        ret.update(Base::pyDict());                                                                                    \
        return ret;                                                                                                    \
    }                                                                                                                  \
    void callPostLoad() override {                                                                                     \
        Base::callPostLoad();                                                                                          \
        postLoad(*this);                                                                                               \
    }                                                                                                                  \
    void pyRegisterClass(::boost::python::object scope) override {                                                     \
        checkPyClassRegistersItself(#Class);                                                                           \
        const ::boost::python::scope thisScope(scope);                                                                 \
        const ::boost::python::docstring_options docOptions(true, true, false);                                        \
        ::boost::python::class_<Class, ::boost::shared_ptr<Class>, ::boost::python::bases<Base>, ::boost::noncopyable> \
            _classObj(#Class, doc);                                                                                    \
        _classObj.def("__init__", ::yade::abi::keywordConstructor<Class>());                                           \
        _classObj.def("updateAttrs", &::yade::abi::updateAttrs<Class>, "Set attributes from a dict, all or none.");    \
        BOOST_PP_SEQ_FOR_EACH(YADE_ABI_TO_PYTHON, Class, attrs)                                                        \
        (void)_classObj py;                                                                                            \
    }
