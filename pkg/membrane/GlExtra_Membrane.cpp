// SPDX-License-Identifier: GPL-2.0-or-later
#ifdef YADE_OPENGL
#include "GlExtra_Membrane.hpp"
#include "MembraneForceEngine.hpp"
#include <GL/glut.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <core/Scene.hpp>
#include <iterator>
#include <lib/high-precision/Constants.hpp>
#include <sstream>

namespace yade {

YADE_PLUGIN((GlExtra_Membrane));
CREATE_LOGGER(GlExtra_Membrane);

namespace {

/// Colours in equal steps, red, green and blue from 0 to 1.
using Scale = std::array<Vector3r, 5>;
/// Viridis: as bright as the value is high, also to the colour-blind and in print.
const Scale strainColours = {{{0.267, 0.005, 0.329},
                              {0.229, 0.322, 0.546},
                              {0.128, 0.567, 0.551},
                              {0.369, 0.789, 0.383},
                              {0.993, 0.906, 0.144}}};
const Scale creaseColours = {
    {{0.85, 0.05, 0.05}, {1.00, 0.35, 0.10}, {1.00, 0.62, 0.30}, {1.00, 0.83, 0.66}, {1.00, 1.00, 1.00}}};
const Vector3r grey(0.5, 0.5, 0.5), dark(0.1, 0.1, 0.1), white(1., 1., 1.);
constexpr Real dullness = 0.65;   ///< share of grey in the colour of what is buckled
constexpr Real edgeOnShade = 0.6; ///< brightness of a face seen edge-on, of one seen straight on

/// Colour of a value between 0 and 1; beyond, that of the nearest.
Vector3r colourOf(const Scale& scale, Real share) {
    const Real place =
        share > 0. ? Real(scale.size() - 1) * std::min(share, Real(1)) : Real(0); // 0 also if it is no number
    const std::size_t below = std::min(static_cast<std::size_t>(place), scale.size() - 2);
    return scale[below] + (place - Real(below)) * (scale[below + 1] - scale[below]);
}

Vector3r strainColour(Real share, bool buckled) {
    const Vector3r colour = colourOf(strainColours, share);
    return buckled ? Vector3r(colour + dullness * (grey - colour)) : colour;
}

/// The first 1, 2 or 5 times a power of ten that is not below `value` > 0.
Real roundedUp(Real value) {
    const Real power = std::pow(10., std::floor(std::log10(value)));
    for (const Real factor : {1., 2., 5.})
        if (factor * power >= value) return factor * power;
    return 10. * power;
}

/// Puts back what was changed of OpenGL's state.
struct KeptState {
    KeptState() { glPushAttrib(GL_ALL_ATTRIB_BITS); }
    ~KeptState() { glPopAttrib(); }
};

/// Within its life, coordinates are pixels of the view from its lower left corner.
struct PixelCoordinates {
    int width, height;
    PixelCoordinates() {
        GLint view[4];
        glGetIntegerv(GL_VIEWPORT, view);
        width = view[2];
        height = view[3];
        glMatrixMode(GL_PROJECTION);
        glPushMatrix();
        glLoadIdentity();
        glOrtho(0., width, 0., height, -1., 1.);
        glMatrixMode(GL_MODELVIEW);
        glPushMatrix();
        glLoadIdentity();
    }
    ~PixelCoordinates() {
        glMatrixMode(GL_PROJECTION);
        glPopMatrix();
        glMatrixMode(GL_MODELVIEW);
        glPopMatrix();
    }
};

void colour(const Vector3r& c) {
    glColor3d(static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2]));
}

void vertex(const Vector3r& p) {
    glVertex3d(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
}

void line(const Vector3r& from, const Vector3r& to) {
    vertex(from);
    vertex(to);
}

void text(const string& words, int x, int y) {
    glRasterPos2i(x, y);
    for (const char letter : words) glutBitmapCharacter(GLUT_BITMAP_HELVETICA_12, letter);
}

/// A scale from left to right; `at` gives the colour of a share between 0 and 1.
template <class At> void bar(int x, int y, int length, int height, At at) {
    glBegin(GL_QUAD_STRIP);
    for (int i = 0; i <= length; ++i) {
        colour(at(Real(i) / length));
        glVertex2i(x + i, y);
        glVertex2i(x + i, y + height);
    }
    glEnd();
}

} // namespace

void GlExtra_Membrane::postLoad(GlExtra_Membrane&) {
    if (!(strainRange >= 0.) || !std::isfinite(strainRange))
        throw std::invalid_argument("GlExtra_Membrane: strainRange = " + std::to_string(strainRange) +
                                    " must be finite and >= 0");
}

void GlExtra_Membrane::render() {
    try { // what is thrown in a picture would end YADE
        draw();
        ++frames;
    } catch (const std::exception& error) {
        LOG_ERROR("the membrane is no longer drawn: " << error.what());
        dead = true;
    }
}

void GlExtra_Membrane::draw() {
    const vector<Shape> all = shapes(); // before OpenGL's state is touched: this may throw
    chooseRange(all);
    const KeptState kept;
    for (const GLenum off : {GL_LIGHTING, GL_CULL_FACE, GL_TEXTURE_2D, GL_BLEND, GL_LINE_SMOOTH}) glDisable(off);
    bool creases = false;
    for (const Shape& shape : all) {
        if (drawFilm) paintFilm(shape);
        if (drawCreases) paintCreases(shape);
        paintSides(shape);
        hideSpheres(shape);
        creases = creases || !shape.membrane->creases.empty();
    }
    hidden_ = hideNodes;
    if (drawLegend && !all.empty()) paintLegend(creases && drawCreases);
}

vector<GlExtra_Membrane::Shape> GlExtra_Membrane::shapes() const {
    vector<Shape> all;
    const std::lock_guard<std::mutex> lock(scene->bodies->drawloopmutex); // while bodies come and go
    const auto known = [&all](const shared_ptr<Membrane>& one) {
        return std::any_of(all.begin(), all.end(), [&one](const Shape& shape) { return shape.membrane == one; });
    };
    for (const auto& engine : scene->engines) {
        auto* const forces = dynamic_cast<MembraneForceEngine*>(engine.get());
        if (!forces) continue;
        const shared_ptr<Membrane> moved = forces->membrane;
        if (!moved || moved->bodyIds.empty() || (membrane && moved != membrane) || known(moved)) continue;
        all.push_back(shape(moved, forces->positionsNow(*scene)));
    }
    if (membrane && !membrane->bodyIds.empty() && !known(membrane))
        all.push_back(shape(membrane, membrane->positions(*scene)));
    return all;
}

GlExtra_Membrane::Shape GlExtra_Membrane::shape(const shared_ptr<Membrane>& of, ::membrane::Points at) const {
    Shape made;
    made.membrane = of;
    made.x = std::move(at);
    const ::membrane::RestState& rest = of->rest();
    for (const ::membrane::Side& side : rest.sides) {
        const Real length = (made.x[side.b] - made.x[side.a]).norm();
        made.strains.push_back(length / side.restLength - 1.);
        made.buckled.push_back(length < side.critical ? 1 : 0);
    }
    const vector<::membrane::FilmState> states = of->filmStatesAt(made.x);
    for (std::size_t i = 0; i < states.size(); ++i) {
        const Vector3i& t = of->triangles[i];
        Real strain = -1.;
        bool buckled = states[i] != ::membrane::FilmState::taut;
        for (int k = 0; k < 3; ++k) {
            const int side = rest.sideBetween(t[k], t[(k + 1) % 3]);
            strain = std::max(strain, made.strains[side]);
            buckled = buckled || (!rest.planeStress && made.buckled[side]);
        }
        made.triangleStrains.push_back(strain);
        made.triangleBuckled.push_back(buckled ? 1 : 0);
    }
    return made;
}

void GlExtra_Membrane::chooseRange(const vector<Shape>& all) {
    if (strainRange > 0.) {
        shownRange = strainRange;
        automatic_ = 0.;
        return;
    }
    constexpr Real least = 1e-6; // a membrane at rest
    vector<Real> strains;
    for (const Shape& shape : all)
        std::copy_if(shape.triangleStrains.begin(), shape.triangleStrains.end(), std::back_inserter(strains),
                     [](Real strain) { return std::isfinite(strain); });
    Real most = least;
    if (!strains.empty()) {
        const auto place = std::next(strains.begin(), static_cast<long>((strains.size() - 1) * 95 / 100));
        std::nth_element(strains.begin(), place, strains.end());
        most = roundedUp(std::max(least, *place));
    }
    if (most > automatic_ || most < 0.2 * automatic_) automatic_ = most;
    shownRange = automatic_;
}

void GlExtra_Membrane::paintFilm(const Shape& shape) const {
    // Faces are shaded by how they are turned to the eye: YADE's lamps would change colours that have a meaning.
    GLdouble view[16];
    glGetDoublev(GL_MODELVIEW_MATRIX, view);
    const Vector3r towardsEye = Vector3r(view[2], view[6], view[10]).normalized();
    glPolygonMode(GL_FRONT_AND_BACK, wire ? GL_LINE : GL_FILL);
    glEnable(GL_POLYGON_OFFSET_FILL); // lines in the faces are in front of them
    glPolygonOffset(1.f, 1.f);
    glBegin(GL_TRIANGLES);
    for (std::size_t i = 0; i < shape.triangleStrains.size(); ++i) {
        const Vector3i& t = shape.membrane->triangles[i];
        const Vector3r &a = shape.x[t[0]], &b = shape.x[t[1]], &c = shape.x[t[2]];
        const Vector3r across = (b - a).cross(c - a);
        const Real area = across.norm();
        const Real facing = area > 0. ? std::abs(across.dot(towardsEye)) / area : 0.;
        colour((edgeOnShade + (1. - edgeOnShade) * facing) *
               strainColour(shape.triangleStrains[i] / shownRange, shape.triangleBuckled[i]));
        vertex(a);
        vertex(b);
        vertex(c);
    }
    glEnd();
}

void GlExtra_Membrane::paintCreases(const Shape& shape) const {
    glLineWidth(3.f);
    glBegin(GL_LINES);
    for (const ::membrane::Crease& c : shape.membrane->rest().creases) {
        colour(colourOf(creaseColours, ::membrane::creaseState(c, shape.x).theta / Mathr::PI));
        line(shape.x[c.a], shape.x[c.b]);
    }
    glEnd();
}

void GlExtra_Membrane::paintSides(const Shape& shape) const {
    const auto paint = [&shape](bool cables, float width) {
        const auto& sides = shape.membrane->rest().sides;
        glLineWidth(width);
        glBegin(GL_LINES);
        for (std::size_t i = 0; i < sides.size(); ++i) {
            if ((sides[i].kind == ::membrane::SideKind::cable) != cables) continue;
            colour(!cables ? dark : shape.buckled[i] ? grey : white);
            line(shape.x[sides[i].a], shape.x[sides[i].b]);
        }
        glEnd();
    };
    if (drawSides) paint(false, 1.f);
    if (drawCables) paint(true, 2.f);
}

void GlExtra_Membrane::paintLegend(bool creases) const {
    constexpr int length = 120, row = 17, height = 11, words = 60, margin = 12; // pixels
    const PixelCoordinates pixels;
    const int x = pixels.width - length - margin - 30;
    int y = margin;
    if (x < words) return; // no room
    glDisable(GL_DEPTH_TEST);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glDisable(GL_POLYGON_OFFSET_FILL);
    const auto label = [&](const string& words_, int at) {
        colour(white);
        text(words_, at, y + 1);
    };
    const auto scale = [&](const string& name, const auto& at) {
        bar(x, y, length, height, at);
        label(name, x - words);
        y += row;
    };
    if (creases) {
        label("closed", x);
        label("flat", x + length - 20);
        y += row;
        scale("crease", [](Real share) { return colourOf(creaseColours, share); });
        y += row / 3;
    }
    if (drawFilm) {
        std::ostringstream most;
        most << shownRange;
        label("0", x);
        label(most.str(), x + length - 20);
        label("strain", x - words);
        y += row;
        for (const bool buckled : {true, false})
            scale(buckled ? "buckled" : "taut", [buckled](Real share) { return strainColour(share, buckled); });
    }
}

void GlExtra_Membrane::hideSpheres(const Shape& shape) const {
    if (!scene->renderer || !(hideNodes || hidden_)) return;
    for (const Body::id_t id : shape.membrane->bodyIds)
        if (hideNodes)
            scene->renderer->hide(id);
        else
            scene->renderer->show(id);
}

} // namespace yade
#endif
