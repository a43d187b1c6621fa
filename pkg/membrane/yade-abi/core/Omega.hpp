// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <lib/factory/ClassFactory.hpp>

#include <boost/date_time/posix_time/posix_time_types.hpp>
#include <map>
#include <mutex>
#include <set>

namespace yade {

class Scene;
class ThreadRunner;

struct DynlibDescriptor {
    std::set<string> baseClasses;
    bool isSerializable;
};

class Omega : public Singleton<Omega> {
    shared_ptr<ThreadRunner> simulationLoop;
    void* simulationFlow_[2];
    std::map<string, DynlibDescriptor> dynlibs;
    // creates one object of each class, notes its bases and registers it in Python's yade.wrapper
    void buildDynlibDatabase(const vector<string>& classes);
    vector<shared_ptr<Scene>> scenes;
    int currentSceneNb;
    shared_ptr<Scene> sceneAnother;
    boost::posix_time::ptime startupLocalTime;
    std::map<string, string> memSavedSimulations;
    std::mutex tmpFileCounterMutex;
    long tmpFileCounter;
    string tmpFileDir;

    friend struct abi::Layout<Omega>;
    FRIEND_SINGLETON(Omega)

public:
    void init();
    void reset();
    const std::map<string, DynlibDescriptor>& getDynlibsDescriptor() const;
    void loadPlugins(vector<string> files);
    bool isInheritingFrom(const string& className, const string& baseName);
    bool isInheritingFrom_recursive(const string& className, const string& baseName);
    string gdbCrashBatch;
    char** origArgv;
    int origArgc;
    // held while the scene changes in ways that drawing must not see
    std::mutex renderMutex;

    void run();
    void pause();
    void step();
    void stop();
    bool isRunning();
    string sceneFile;
    void loadSimulation(const string& name, bool quiet = false);
    void saveSimulation(const string& name, bool quiet = false);

    void resetScene();
    const shared_ptr<Scene>& getScene() const;
    int addScene();
    void switchToScene(int i);
    string tmpFilename();
    Real getRealTime() const;
    string confDir;

    Omega();
};

YADE_ABI_LAYOUT(DynlibDescriptor, 56, ((baseClasses, 0))((isSerializable, 48)));
YADE_ABI_LAYOUT(Omega, 416,
                ((simulationLoop, 0))((dynlibs, 32))((scenes, 80))((currentSceneNb, 104))((startupLocalTime, 128))(
                    (memSavedSimulations, 136))((tmpFileCounter, 224))((tmpFileDir, 232))((gdbCrashBatch, 264))(
                    (renderMutex, 312))((sceneFile, 352))((confDir, 384)));

} // namespace yade
