// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Body.hpp>
#include <core/BodyContainer.hpp>
#include <core/Cell.hpp>
#include <core/EnergyTracker.hpp>
#include <core/Engine.hpp>
#include <core/ForceContainer.hpp>
#include <core/InteractionContainer.hpp>
#include <core/Material.hpp>

#include <boost/date_time/posix_time/posix_time_types.hpp>

namespace yade {

class DisplayParameters;
class OpenGLRenderer;

class Scene : public Serializable {
    const unsigned int hostNameMax;
    friend struct abi::Layout<Scene>;

public:
    // returns the new id
    int addMaterial(shared_ptr<Material> m) {
        materials.push_back(m);
        return m->id = int(materials.size()) - 1;
    }
    void checkStateTypes();
    void updateBound();

    ForceContainer forces;

    void fillDefaultTags();
    void moveToNextTimeStep();
    // these throw if there are two
    bool timeStepperPresent();
    bool timeStepperActive();
    bool timeStepperActivate(bool);

    static const int nSpeedIter = 10;
    Eigen::Matrix<Real, nSpeedIter, 1> SpeedElements;
    shared_ptr<Engine> engineByName(const string& className);
    shared_ptr<OpenGLRenderer> renderer;
    void postLoad(Scene&);
    boost::posix_time::ptime prevTime;

    Real dt;
    long iter;
    bool subStepping;
    int subStep;
    Real time;
    Real speed;
    long stopAtIter;
    Real stopAtTime;
    bool isPeriodic;
    bool trackEnergy;
    bool doSort;
    bool runInternalConsistencyChecks;
    Body::id_t selectedBody;
    int subdomain;
    shared_ptr<Shape> subD;
    vector<string> tags;
    vector<shared_ptr<Engine>> engines;
    vector<shared_ptr<Engine>> _nextEngines;
    shared_ptr<BodyContainer> bodies;
    shared_ptr<InteractionContainer> interactions;
    shared_ptr<EnergyTracker> energy;
    vector<shared_ptr<Material>> materials;
    shared_ptr<Bound> bound;
    shared_ptr<Cell> cell;
    vector<shared_ptr<Serializable>> miscParams;
    vector<shared_ptr<DisplayParameters>> dispParams;

    Scene();
    virtual ~Scene();
    DECLARE_LOGGER;
    YADE_ABI_SERIALIZABLE
};

YADE_ABI_LAYOUT(Scene, 752,
                ((hostNameMax, 24))((forces, 32))((SpeedElements, 336))((renderer, 416))((prevTime, 432))((dt, 440))(
                    (iter, 448))((subStepping, 456))((subStep, 460))((time, 464))((speed, 472))((stopAtIter, 480))(
                    (stopAtTime, 488))((isPeriodic, 496))((trackEnergy, 497))((doSort, 498))(
                    (runInternalConsistencyChecks, 499))((selectedBody, 500))((subdomain, 504))((subD, 512))(
                    (tags, 528))((engines, 552))((_nextEngines, 576))((bodies, 600))((interactions, 616))(
                    (energy, 632))((materials, 648))((bound, 672))((cell, 688))((miscParams, 704))((dispParams, 728)));
YADE_ABI_SAVED(Scene)

} // namespace yade
