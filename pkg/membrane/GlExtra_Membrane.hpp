// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#ifdef YADE_OPENGL
#include "Membrane.hpp"
#include <lib/base/Logging.hpp>
#include <pkg/common/OpenGLRenderer.hpp>

namespace yade {

class GlExtra_Membrane : public GlExtraDrawer {
public:
    void render() override;
    void postLoad(GlExtra_Membrane&);

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(GlExtra_Membrane, GlExtraDrawer,
        "Draws membranes in YADE's 3D view: triangles coloured by strain, creases by angle. The strain of a triangle is the largest of its three "
        "sides', length over rest length - 1; colours are dull where one of the sides is buckled or a film of plane stress wrinkled or slack. Append it to yade.qt.Renderer().extraDrawers, or let "
        "membrane.window.show do so. What it draws is up to date in every picture, also in the middle of a run with a large "
        ":yref:`exchangePeriod<MembraneIntegrator.exchangePeriod>`. Where it fails it says why, once, and is dead from then on.",
        ((shared_ptr<Membrane>, membrane, , , "Membrane to draw; none: all that have a MembraneForceEngine in the scene."))
        ((Real, strainRange, 0., Attr::triggerPostLoad, "Strain at the bright end of the scale, >= 0 [-]; at the dark end it is 0. "
            "0: the first 1, 2 or 5 times a power of ten above that of 95 % of the triangles, which changes seldom."))
        ((bool, wire, false, , "Draw triangles as outlines only."))
        ((bool, drawFilm, true, , "Draw the triangles."))
        ((bool, drawCreases, true, , "Draw the creases: red closed, 0, to white flat, pi."))
        ((bool, drawSides, false, , "Draw the sides of the mesh as thin lines."))
        ((bool, drawCables, true, , "Draw the cables: white taut, grey slack."))
        ((bool, drawLegend, true, , "Draw the scales in the lower right corner."))
        ((bool, hideNodes, true, , "Hide the spheres of the nodes."))
        ((Real, shownRange, 0., (Attr::readonly | Attr::noSave), "Strain at the bright end of the scale in the last picture [-]."))
        ((int, frames, 0, (Attr::readonly | Attr::noSave), "Pictures drawn so far [-]."))
        ,
        ,
    );
    // clang-format on
    DECLARE_LOGGER;

private:
    /// A membrane as it is now.
    struct Shape {
        shared_ptr<Membrane> membrane;
        ::membrane::Points x;         ///< [m]
        vector<Real> strains;         ///< of the sides [-]
        vector<char> buckled;         ///< whether the sides are
        vector<Real> triangleStrains; ///< [-]
        vector<char> triangleBuckled;
    };

    void draw();
    vector<Shape> shapes() const;
    Shape shape(const shared_ptr<Membrane>& of, ::membrane::Points at) const;
    void chooseRange(const vector<Shape>& all);
    void paintFilm(const Shape& shape) const;
    void paintCreases(const Shape& shape) const;
    void paintSides(const Shape& shape) const;
    void paintLegend(bool creases) const;
    void hideSpheres(const Shape& shape) const;

    Real automatic_ = 0.; ///< range chosen last; 0: none was
    bool hidden_ = false; ///< the nodes' spheres
};
REGISTER_SERIALIZABLE(GlExtra_Membrane);

} // namespace yade
#endif
