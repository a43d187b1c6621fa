// SPDX-License-Identifier: GPL-2.0-or-later
#include "kernels/MathFlags.hpp" // like a CREATE_CPP_LOCAL_LOGGER it keeps this out of unity builds

#include "MembraneForce.hpp"
#include "kernels/TriangleForce.hpp"
#include "mechanics/SolarPressure.hpp"

namespace yade {

class SolarPressure : public MembraneForce {
public:
    void postLoad(SolarPressure&);
    std::shared_ptr<::membrane::ElementForce> make() const override;
    ::membrane::Sunlight sunlight() const { return {direction.normalized(), pressure, specular, diffuse}; }

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(SolarPressure, MembraneForce,
        "Pressure of sunlight on the triangles of a :yref:`Membrane`, which has the same two sides and throws no shadow on itself. Its work is booked as 'sunlight'.",
        ((Vector3r, direction, Vector3r(0., 0., -1.), Attr::triggerPostLoad, "Along which the light travels [-], of any length > 0."))
        ((Real, pressure, 4.54e-6, Attr::triggerPostLoad, "On a black plate across the light [Pa], >= 0; the default is that at the Earth's distance from the sun."))
        ((Real, specular, 0., Attr::triggerPostLoad, "Share reflected as by a mirror [-], >= 0."))
        ((Real, diffuse, 0., Attr::triggerPostLoad, "Share reflected diffusely [-], >= 0; together with `specular` <= 1, the rest is absorbed."))
        ,
        ,
    );
    // clang-format on
};
REGISTER_SERIALIZABLE(SolarPressure);

} // namespace yade

namespace membrane {
namespace {

MEMBRANE_VECTORISED void addSunlight(const Sunlight& light, const Arrangement<3>& order, int group,
                                     const GroupJob& job) {
    BlockVectors room[3], third;
    for (int i = order.groups[group]; i < order.groups[group + 1]; ++i) {
        const Block block = order.blocks[i];
        const OfCorners x = ofCorners(order, block, job.x, room);
        const int padded = block.paddedCount();
        const Components force = third.components();
#pragma GCC ivdep
        for (int e = 0; e < padded; ++e)
            force.set(e, 1. / 3. * solarForce(light, doubleArea(x.a.at(e), x.b.at(e), x.c.at(e))));
        clearPadding(block, third);
        for (int k = 0; k < 3; ++k) addCorner(block, third, order.node[k].data() + block.begin, job.own);
    }
}

class SolarForce : public TriangleForce {
public:
    explicit SolarForce(const boost::shared_ptr<const yade::SolarPressure>& of)
        : TriangleForce(of->membrane->triangles), sun_(of), membrane_(of->membrane) {}

    const char* channel() const override { return "sunlight"; }
    const char* title() const override { return "sunlight"; }
    Exchange exchange() const override { return Exchange::brings; }
    GroupEnergy add(int group, const GroupJob& job) override {
        addSunlight(sun_->sunlight(), order_, group, job);
        return {};
    }
    void addTo(LinearForces& to, const Points& x, const Points&) const override {
        const double slope = solarSlope(sun_->sunlight());
        for (const Eigen::Vector3i& t : *triangles_) {
            // A corner that moves by d changes the doubled area by its opposite side times d, or less.
            const double around = (x[t[1]] - x[t[0]]).norm() + (x[t[2]] - x[t[1]]).norm() + (x[t[0]] - x[t[2]]).norm();
            for (int k = 0; k < 3; ++k) to.addGround(t[k], slope / 3. * around);
        }
    }

private:
    boost::shared_ptr<const yade::SolarPressure> sun_;
    boost::shared_ptr<const yade::Membrane> membrane_;
};

} // namespace
} // namespace membrane

namespace yade {

YADE_PLUGIN((SolarPressure));

void SolarPressure::postLoad(SolarPressure&) {
    const StepGuard::Look look;
    const auto refuse = [](const string& what) { throw std::invalid_argument("SolarPressure: " + what); };
    if (!direction.allFinite() || direction.isZero(0.)) refuse("direction must be finite and not 0");
    if (!(pressure >= 0.) || !std::isfinite(pressure))
        refuse("pressure = " + std::to_string(pressure) + " Pa must be finite and >= 0");
    if (!(specular >= 0. && diffuse >= 0. && specular + diffuse <= 1.))
        refuse("specular = " + std::to_string(specular) + " and diffuse = " + std::to_string(diffuse) +
               " must be >= 0, and together <= 1");
}

std::shared_ptr<::membrane::ElementForce> SolarPressure::make() const {
    return std::make_shared<::membrane::SolarForce>(
        boost::static_pointer_cast<const SolarPressure>(shared_from_this()));
}

} // namespace yade
