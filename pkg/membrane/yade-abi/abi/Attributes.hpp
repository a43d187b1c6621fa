// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// What the YADE_CLASS_BASE_DOC macros of lib/serialization/Serializable.hpp expand to, one attribute at a time.
// An attribute is a tuple (type, name, default, flags, doc), of which default and flags may be empty.

#include <lib/factory/Factorable.hpp>

#include <boost/python.hpp>
#include <boost/python/raw_function.hpp>
#include <functional>
#include <memory>
#include <type_traits>

#define YADE_ABI_TYPE(attr) BOOST_PP_TUPLE_ELEM(5, 0, attr)
#define YADE_ABI_NAME(attr) BOOST_PP_TUPLE_ELEM(5, 1, attr)
#define YADE_ABI_DEFAULT(attr) BOOST_PP_TUPLE_ELEM(5, 2, attr)
#define YADE_ABI_FLAGS(attr) (BOOST_PP_TUPLE_ELEM(5, 3, attr) + 0) // +0 turns an empty field into a number
#define YADE_ABI_DOC(attr) BOOST_PP_TUPLE_ELEM(5, 4, attr)
#define YADE_ABI_NAME_TEXT(attr) BOOST_PP_STRINGIZE(YADE_ABI_NAME(attr))

// The graphical interface reads default and type of an attribute from its doc string, and the flags after them.
#define YADE_ABI_FULL_DOC(attr)                                                                                        \
    YADE_ABI_DOC(attr)                                                                                                 \
    " :ydefault:`" BOOST_PP_STRINGIZE(YADE_ABI_DEFAULT(attr)) "` :yattrtype:`" BOOST_PP_STRINGIZE(                     \
        YADE_ABI_TYPE(attr)) "`"

// loop bodies, one per generated function
#define YADE_ABI_DECLARE(r, data, attr) YADE_ABI_TYPE(attr) YADE_ABI_NAME(attr);
#define YADE_ABI_AS_INITIALIZER(s, data, attr) (YADE_ABI_NAME(attr), YADE_ABI_DEFAULT(attr))
#define YADE_ABI_INITIALIZE(s, data, init) BOOST_PP_TUPLE_ELEM(2, 0, init)(BOOST_PP_TUPLE_ELEM(2, 1, init))
#define YADE_ABI_SAVE(r, archive, attr)                                                                                \
    if (!(YADE_ABI_FLAGS(attr) & ::yade::Attr::noSave))                                                                \
        (archive) & ::boost::serialization::make_nvp(YADE_ABI_NAME_TEXT(attr), this->YADE_ABI_NAME(attr));
#define YADE_ABI_SET(r, data, attr)                                                                                    \
    if (key == YADE_ABI_NAME_TEXT(attr)) {                                                                             \
        ::yade::abi::Changes::set(this->YADE_ABI_NAME(attr),                                                           \
                                  ::boost::python::extract<decltype(this->YADE_ABI_NAME(attr))>(value)());             \
        return;                                                                                                        \
    }
#define YADE_ABI_TO_DICT(r, dict, attr)                                                                                \
    if (!(YADE_ABI_FLAGS(attr) & ::yade::Attr::hidden))                                                                \
        (dict)[YADE_ABI_NAME_TEXT(attr)] = ::boost::python::object(this->YADE_ABI_NAME(attr));
#define YADE_ABI_TO_PYTHON(r, Class, attr)                                                                             \
    ::yade::abi::defineAttribute<YADE_ABI_FLAGS(attr)>(_classObj, YADE_ABI_NAME_TEXT(attr),                            \
                                                       &Class::YADE_ABI_NAME(attr), YADE_ABI_FULL_DOC(attr));

// `: name(default), ...`, or nothing; initializers of YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY come first
#define YADE_ABI_INITIALIZERS(inits)                                                                                   \
    BOOST_PP_IF(BOOST_PP_SEQ_SIZE(inits), YADE_ABI_INITIALIZERS_SOME, BOOST_PP_TUPLE_EAT(1))(inits)
#define YADE_ABI_INITIALIZERS_SOME(inits) : BOOST_PP_SEQ_ENUM(BOOST_PP_SEQ_TRANSFORM(YADE_ABI_INITIALIZE, ~, inits))
#define YADE_ABI_ALL_INITIALIZERS(inits, attrs)                                                                        \
    inits BOOST_PP_IF(BOOST_PP_SEQ_SIZE(attrs), BOOST_PP_SEQ_TRANSFORM,                                                \
                      BOOST_PP_TUPLE_EAT(3))(YADE_ABI_AS_INITIALIZER, ~, attrs)

namespace yade {

namespace Attr {
enum flags { noSave = 1 << 0, readonly = 1 << 1, triggerPostLoad = 1 << 2, hidden = 1 << 3, noResize = 1 << 4 };
}

// Called around saving and loading; a class intercepts one by a member function of the same name and parameter.
template <typename T> void preLoad(T&) {}
template <typename T> void postLoad(T&) {}
template <typename T> void preSave(T&) {}
template <typename T> void postSave(T&) {}

namespace abi {
namespace py = ::boost::python;

// Kept while Python reads or sets an attribute. The plugin defines it: it knows what else may do so at that time.
class Access {
public:
    Access();
    ~Access();

private:
    std::shared_ptr<void> held_;
};

// The changes of attributes in its life, which are taken back unless they are kept. More than YADE does: there an
// attribute is left with a value that was refused.
class Changes {
public:
    Changes() : outer_(current_) { current_ = this; }
    ~Changes() {
        current_ = outer_;
        PyObject *type, *value, *trace; // of what is being raised
        PyErr_Fetch(&type, &value, &trace);
        for (auto back = back_.rbegin(); back != back_.rend(); ++back) try {
                (*back)();
            } catch (const py::error_already_set&) { // it was no attribute
                PyErr_Clear();
            }
        PyErr_Restore(type, value, trace);
    }
    Changes(const Changes&) = delete;
    Changes& operator=(const Changes&) = delete;

    template <class T> static void set(T& attribute, const T& value) {
        remember([&attribute, old = attribute] { attribute = old; });
        attribute = value;
    }
    static void remember(std::function<void()> back) {
        if (current_) current_->back_.push_back(std::move(back));
    }
    void keep() { back_.clear(); }

private:
    inline static thread_local Changes* current_ = nullptr;
    Changes* outer_;
    std::vector<std::function<void()>> back_; // what brings each of them back
};

// Changes attributes and lets the object see to what follows from them; or, if that is refused, does neither.
template <class Class, class Change> void change(Class& object, Change apply) {
    const Access access;
    try {
        Changes changes;
        apply();
        changes.keep();
    } catch (...) {
        try {
            object.callPostLoad();
        } catch (...) { // it refuses the old ones, too
        }
        throw;
    }
}

template <class Class> void updateAttrs(const py::object& self, const py::dict& values) {
    Class& object = py::extract<Class&>(self);
    change(object, [&] {
        // Those that YADE's own functions set, too.
        const py::list names = values.keys();
        for (py::ssize_t i = 0; i < py::len(names); ++i) {
            const py::object name(names[i]);
            if (!PyObject_HasAttr(self.ptr(), name.ptr())) continue;
            const string key = py::extract<string>(name);
            Changes::remember([&object, key, old = py::object(self.attr(name))] { object.pySetAttr(key, old); });
        }
        object.pyUpdateAttrs(values);
    });
}

// Python may change a component of these in place, as in state.vel[2] = 0; of anything else it gets a copy.
template <class T> struct GivenByReference : std::false_type {};
template <> struct GivenByReference<Vector2i> : std::true_type {};
template <> struct GivenByReference<Vector2r> : std::true_type {};
template <> struct GivenByReference<Vector3i> : std::true_type {};
template <> struct GivenByReference<Vector3r> : std::true_type {};
template <> struct GivenByReference<Quaternionr> : std::true_type {};
template <> struct GivenByReference<Matrix3r> : std::true_type {};

template <int flags, class PythonClass, class Class, class T>
void defineAttribute(PythonClass& pythonClass, const char* name, T Class::*attribute, string doc) {
    if constexpr (!(flags & Attr::hidden)) {
        using Policy = std::conditional_t<GivenByReference<T>::value, py::return_internal_reference<>,
                                          py::return_value_policy<py::return_by_value>>;
        doc += " :yattrflags:`" + std::to_string(flags) + "` ";
        const auto get = [attribute](const Class& object) -> T {
            const Access access;
            return object.*attribute;
        };
        const py::object getter =
            GivenByReference<T>::value || std::is_arithmetic<T>::value
                ? py::make_getter(attribute, Policy())
                : py::make_function(get, py::default_call_policies(), boost::mpl::vector2<T, const Class&>());
        if constexpr (flags & Attr::readonly) {
            pythonClass.add_property(name, getter, doc.c_str());
        } else {
            const auto set = [attribute](Class& object, const T& value) {
                change(object, [&] {
                    Changes::set(object.*attribute, value);
                    if (flags & Attr::triggerPostLoad) object.callPostLoad();
                });
            };
            const py::object setter =
                py::make_function(set, py::default_call_policies(), boost::mpl::vector3<void, Class&, const T&>());
            pythonClass.add_property(name, getter, setter, doc.c_str());
        }
    }
}

template <class Class> shared_ptr<Class> construct(py::tuple args, py::dict keywords) {
    shared_ptr<Class> object(new Class);
    object->pyHandleCustomCtorArgs(args, keywords);
    if (const auto extra = py::len(args))
        throw runtime_error(object->getClassName() + " takes keyword arguments only, but got " + std::to_string(extra) +
                            " without a keyword.");
    if (py::len(keywords) > 0) {
        object->pyUpdateAttrs(keywords);
        object->callPostLoad();
    }
    return object;
}

// __init__ of a Python class: Boost.Python knows no constructor with arbitrary keywords, so wrap the one above.
template <class Class> py::object keywordConstructor() {
    const py::object init = py::make_constructor(&construct<Class>);
    return py::raw_function(
        [init](const py::tuple& args, const py::dict& keywords) {
            const py::object self(args[0]);
            return py::object(init(self, py::tuple(args.slice(1, py::len(args))), keywords));
        },
        1);
}
} // namespace abi

} // namespace yade
