// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lib/base/Logging.hpp>
#include <lib/serialization/Serializable.hpp>

namespace yade {

// The periodic cell; its columns of hSize are the periods.
class Cell : public Serializable {
    Matrix3r _invTrsf;
    Matrix3r _trsfInc;
    Matrix3r _vGradTimesPrevH;
    Vector3r _size, _cos;
    Vector3r _refSize;
    bool _hasShear;
    Matrix3r _shearTrsf, _unshearTrsf;
    double _glShearTrsfMatrix[16];
    friend struct abi::Layout<Cell>;

public:
    const Vector3r& getSize() const { return _size; }
    bool hasShear() const { return _hasShear; }
    Vector3r shearPt(const Vector3r&) const;
    Vector3r unshearPt(const Vector3r&) const;
    // position and velocity of a body's image so many periods away, relative to the body
    Vector3r intrShiftPos(const Vector3i& periods) const { return hSize * periods.cast<Real>(); }
    Vector3r intrShiftVel(const Vector3i& periods) const { return _vGradTimesPrevH * periods.cast<Real>(); }
    Real getVolume() const;

    enum { HOMO_NONE = 0, HOMO_POS = 1, HOMO_VEL = 2, HOMO_VEL_2ND = 3 };
    Matrix3r trsf;
    Matrix3r refHSize;
    Matrix3r hSize;
    Matrix3r prevHSize;
    Matrix3r velGrad;
    Matrix3r nextVelGrad;
    Matrix3r prevVelGrad;
    int homoDeform;
    bool velGradChanged;
    bool flipFlippable;

    Cell();
    virtual ~Cell();
    DECLARE_LOGGER;
    YADE_ABI_SERIALIZABLE
};

YADE_ABI_LAYOUT(
    Cell, 1104,
    ((_invTrsf, 24))((_vGradTimesPrevH, 168))((_size, 240))((_refSize, 288))((_hasShear, 312))((_shearTrsf, 320))(
        (_glShearTrsfMatrix, 464))((trsf, 592))((refHSize, 664))((hSize, 736))((prevHSize, 808))((velGrad, 880))(
        (nextVelGrad, 952))((prevVelGrad, 1024))((homoDeform, 1096))((velGradChanged, 1100))((flipFlippable, 1101)));
YADE_ABI_SAVED(Cell)

} // namespace yade
