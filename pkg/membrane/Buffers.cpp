// SPDX-License-Identifier: GPL-2.0-or-later
#include "Buffers.hpp"
#include <cstdint>
#include <cstring>

namespace yade {
namespace {

/// The memory of a Python object, if it offers it.
struct View {
    Py_buffer buffer;
    bool open;

    explicit View(PyObject* object)
        : open(PyObject_CheckBuffer(object) && PyObject_GetBuffer(object, &buffer, PyBUF_RECORDS_RO) == 0) {
        PyErr_Clear();
    }
    ~View() {
        if (open) PyBuffer_Release(&buffer);
    }
    View(const View&) = delete;
    View& operator=(const View&) = delete;

    /// Letter of module struct for the numbers; 0 if they are several or in another order of bytes.
    char kind() const {
        const char* format = buffer.format ? buffer.format : "B";
        if (std::strchr("@=<", *format)) ++format;
        return *format && !format[1] ? *format : '\0';
    }

    string shape() const {
        string text;
        for (int i = 0; i < buffer.ndim; ++i) text += (i ? ", " : "") + std::to_string(buffer.shape[i]);
        return "(" + text + (buffer.ndim == 1 ? ",)" : ")");
    }
};

template <class T> struct Entry {
    using Scalar = typename T::Scalar;
    static constexpr int size = T::SizeAtCompileTime;
};
template <> struct Entry<Real> {
    using Scalar = Real;
    static constexpr int size = 1;
};
template <> struct Entry<int> {
    using Scalar = int;
    static constexpr int size = 1;
};

template <class From, class T> bool copyNumbers(const Py_buffer& from, const string& field, vector<T>& values) {
    using Scalar = typename Entry<T>::Scalar;
    values.resize(from.shape[0]);
    for (Py_ssize_t i = 0; i < from.shape[0]; ++i) {
        Scalar* const entry = reinterpret_cast<Scalar*>(&values[i]);
        for (int j = 0; j < Entry<T>::size; ++j) {
            From number;
            std::memcpy(&number,
                        static_cast<const char*>(from.buf) + i * from.strides[0] + (j ? j * from.strides[1] : 0),
                        sizeof number);
            entry[j] = static_cast<Scalar>(number);
            if constexpr (std::is_integral_v<Scalar>)
                if (entry[j] != number)
                    throw std::invalid_argument(field + "[" + std::to_string(i) + "] holds " + std::to_string(number) +
                                                "; it must fit into 32 bits");
        }
    }
    return true;
}

} // namespace

template <class T> bool copyBuffer(const boost::python::object& given, const string& field, vector<T>& values) {
    static_assert(sizeof(T) == Entry<T>::size * sizeof(typename Entry<T>::Scalar));
    const View view(given.ptr());
    if (!view.open) return false;
    const char kind = view.kind();
    const bool whole = kind && std::strchr("ilq", kind);
    if (!whole && (std::is_integral_v<typename Entry<T>::Scalar> || !kind || !std::strchr("df", kind))) return false;

    const Py_buffer& from = view.buffer;
    constexpr int size = Entry<T>::size;
    if (from.len == 0) {
        values.clear();
        return true;
    }
    if (size == 1 ? from.ndim != 1 : from.ndim != 2 || from.shape[1] != size)
        throw std::invalid_argument(field + " has the shape " + view.shape() + "; it must be " +
                                    (size == 1 ? "(n,)" : "(n, " + std::to_string(size) + ")"));
    if (kind == 'd') return copyNumbers<double>(from, field, values);
    if (kind == 'f') return copyNumbers<float>(from, field, values);
    if (from.itemsize == 4) return copyNumbers<std::int32_t>(from, field, values);
    return copyNumbers<std::int64_t>(from, field, values);
}

template bool copyBuffer(const boost::python::object&, const string&, vector<Vector3r>&);
template bool copyBuffer(const boost::python::object&, const string&, vector<Vector3i>&);
template bool copyBuffer(const boost::python::object&, const string&, vector<Vector2i>&);
template bool copyBuffer(const boost::python::object&, const string&, vector<Real>&);
template bool copyBuffer(const boost::python::object&, const string&, vector<int>&);

vector<Vector3r> pointsFrom(const boost::python::object& given, const std::string& field) {
    vector<Vector3r> points;
    if (copyBuffer(given, field, points)) return points;
    return boost::python::extract<vector<Vector3r>>(given)();
}

} // namespace yade
