// Size of every declared class and place of every member, as they are in Debian's YADE 2023.02a (amd64). The numbers
// were read from that build: sizes from the allocations in its libraries, offsets from objects it makes. Compiling
// this file is the test; virtual_tables.py reads the compiler's dump of the same classes.
#include <cstddef>

#include <core/Dispatching.hpp>
#include <core/InteractionLoop.hpp>
#include <core/PartialEngine.hpp>
#include <core/Scene.hpp>
#include <core/TimeStepper.hpp>
#include <pkg/common/Box.hpp>
#include <pkg/common/ElastMat.hpp>
#include <pkg/common/GLDrawFunctors.hpp>
#include <pkg/common/MatchMaker.hpp>
#include <pkg/common/PeriodicEngines.hpp>
#include <pkg/dem/FrictPhys.hpp>
#include <pkg/dem/ScGeom.hpp>

namespace yade {

#define SIZE(Class, bytes) static_assert(sizeof(Class) == bytes, #Class)
#define AT(Class, member, bytes) static_assert(offsetof(Class, member) == bytes, #Class "::" #member)

SIZE(Factorable, 24);
SIZE(Serializable, 24);
SIZE(Indexable, 8);
SIZE(TimingInfo, 16);
SIZE(TimingDeltas, 64);
SIZE(Se3r, 56);

SIZE(Engine, 104);
AT(Engine, scene, 24);
AT(Engine, timingInfo, 32);
AT(Engine, timingDeltas, 48);
AT(Engine, dead, 64);
AT(Engine, ompThreads, 68);
AT(Engine, label, 72);
SIZE(GlobalEngine, 104);
SIZE(PartialEngine, 128);
AT(PartialEngine, ids, 104);
SIZE(PeriodicEngine, 184);
AT(PeriodicEngine, virtPeriod, 104);
AT(PeriodicEngine, realPeriod, 112);
AT(PeriodicEngine, iterPeriod, 120);
AT(PeriodicEngine, nDo, 128);
AT(PeriodicEngine, initRun, 136);
AT(PeriodicEngine, firstIterRun, 144);
AT(PeriodicEngine, virtLast, 152);
AT(PeriodicEngine, realLast, 160);
AT(PeriodicEngine, iterLast, 168);
AT(PeriodicEngine, nDone, 176);
SIZE(TimeStepper, 112);
AT(TimeStepper, active, 104);
AT(TimeStepper, timeStepUpdateInterval, 108);
SIZE(InteractionLoop, 216);
AT(InteractionLoop, alreadyWarnedNoCollider, 104);
AT(InteractionLoop, eraseAfterLoopIds, 112);
AT(InteractionLoop, geomDispatcher, 136);
AT(InteractionLoop, physDispatcher, 152);
AT(InteractionLoop, lawDispatcher, 168);
AT(InteractionLoop, callbacks, 184);
AT(InteractionLoop, loopOnSortedInteractions, 208);
SIZE(Dispatcher, 104);
SIZE(BoundDispatcher, 216);
AT(BoundDispatcher, functors, 152);
AT(BoundDispatcher, activated, 176);
AT(BoundDispatcher, sweepDist, 184);
AT(BoundDispatcher, minSweepDistFactor, 192);
AT(BoundDispatcher, updatingDispFactor, 200);
AT(BoundDispatcher, targetInterv, 208);
SIZE(IGeomDispatcher, 184);
AT(IGeomDispatcher, functors, 160);
SIZE(IPhysDispatcher, 176);
AT(IPhysDispatcher, functors, 152);
SIZE(LawDispatcher, 176);
AT(LawDispatcher, functors, 152);

SIZE(State, 320);
AT(State, updateMutex, 48);
AT(State, se3, 88);
AT(State, vel, 144);
AT(State, mass, 168);
AT(State, angVel, 176);
AT(State, angMom, 200);
AT(State, inertia, 224);
AT(State, refPos, 248);
AT(State, refOri, 272);
AT(State, blockedDOFs, 304);
AT(State, isDamped, 308);
AT(State, densityScaling, 312);

SIZE(Body, 176);
AT(Body, id, 24);
AT(Body, groupMask, 28);
AT(Body, flags, 32);
AT(Body, subdomain, 36);
AT(Body, material, 40);
AT(Body, state, 56);
AT(Body, shape, 72);
AT(Body, bound, 88);
AT(Body, intrs, 104);
AT(Body, clumpId, 152);
AT(Body, iterBorn, 160);
AT(Body, timeBorn, 168);
SIZE(BodyContainer, 200);
AT(BodyContainer, body, 24);
AT(BodyContainer, dirty, 48);
AT(BodyContainer, checkedByCollider, 49);
AT(BodyContainer, insertedBodies, 56);
AT(BodyContainer, erasedBodies, 80);
AT(BodyContainer, realBodies, 104);
AT(BodyContainer, useRedirection, 128);
AT(BodyContainer, enableRedirection, 129);
AT(BodyContainer, subdomainBodies, 136);
AT(BodyContainer, drawloopmutex, 160);

SIZE(Shape, 96);
AT(Shape, boundFunctor, 32);
AT(Shape, internalforcefunctor, 48);
AT(Shape, color, 64);
AT(Shape, wire, 88);
AT(Shape, highlight, 89);
SIZE(Box, 120);
AT(Box, extents, 96);

SIZE(Material, 80);
AT(Material, id, 32);
AT(Material, label, 40);
AT(Material, density, 72);
SIZE(ElastMat, 96);
AT(ElastMat, young, 80);
AT(ElastMat, poisson, 88);
SIZE(FrictMat, 104);
AT(FrictMat, frictionAngle, 96);

SIZE(Bound, 144);
AT(Bound, lastUpdateIter, 32);
AT(Bound, refPos, 40);
AT(Bound, sweepLength, 64);
AT(Bound, color, 72);
AT(Bound, min, 96);
AT(Bound, max, 120);
SIZE(Aabb, 144);

SIZE(IGeom, 32);
SIZE(GenericSpheresContact, 96);
AT(GenericSpheresContact, normal, 32);
AT(GenericSpheresContact, contactPoint, 56);
AT(GenericSpheresContact, refR1, 80);
AT(GenericSpheresContact, refR2, 88);
SIZE(ScGeom, 192);
AT(ScGeom, twist_axis, 96);
AT(ScGeom, orthonormal_axis, 120);
AT(ScGeom, penetrationDepth, 160);
AT(ScGeom, shearInc, 168);
SIZE(IPhys, 32);
SIZE(NormPhys, 64);
AT(NormPhys, kn, 32);
AT(NormPhys, normalForce, 40);
SIZE(NormShearPhys, 96);
AT(NormShearPhys, ks, 64);
AT(NormShearPhys, shearForce, 72);
SIZE(FrictPhys, 104);
AT(FrictPhys, tangensOfFrictionAngle, 96);
SIZE(MatchMaker, 160);

SIZE(Interaction, 168);
AT(Interaction, isActive, 24);
AT(Interaction, functorCache, 32);
AT(Interaction, functorCache.geom, 40);
AT(Interaction, functorCache.phys, 56);
AT(Interaction, functorCache.constLaw, 72);
AT(Interaction, id1, 88);
AT(Interaction, id2, 92);
AT(Interaction, iterMadeReal, 96);
AT(Interaction, iterLastSeen, 104);
AT(Interaction, geom, 112);
AT(Interaction, phys, 128);
AT(Interaction, cellDist, 144);
AT(Interaction, linIx, 156);
AT(Interaction, iterBorn, 160);
SIZE(InteractionContainer, 192);
AT(InteractionContainer, linIntrs, 24);
AT(InteractionContainer, sortedIntrs, 48);
AT(InteractionContainer, bodies, 72);
AT(InteractionContainer, currSize, 80);
AT(InteractionContainer, empty, 88);
AT(InteractionContainer, interaction, 104);
AT(InteractionContainer, dirty, 128);
AT(InteractionContainer, drawloopmutex, 136);
AT(InteractionContainer, serializeSorted, 176);
AT(InteractionContainer, iterColliderLastRun, 184);

SIZE(ForceContainer, 304);
AT(ForceContainer, _forceData, 0);
AT(ForceContainer, _torqueData, 24);
AT(ForceContainer, _maxId, 48);
AT(ForceContainer, sizeOfThreads, 72);
AT(ForceContainer, _force, 96);
AT(ForceContainer, _torque, 120);
AT(ForceContainer, _permForce, 144);
AT(ForceContainer, _permTorque, 168);
AT(ForceContainer, size, 192);
AT(ForceContainer, syncedSizes, 200);
AT(ForceContainer, nThreads, 204);
AT(ForceContainer, permForceUsed, 208);
AT(ForceContainer, permForceSynced, 209);
AT(ForceContainer, globalMutex, 216);
AT(ForceContainer, _zero, 256);
AT(ForceContainer, synced, 280);
AT(ForceContainer, syncCount, 288);
AT(ForceContainer, lastReset, 296);
SIZE(EnergyAccumulator, 64);
AT(EnergyAccumulator, threads, 8);
AT(EnergyAccumulator, perLine, 16);
AT(EnergyAccumulator, chunks, 24);
AT(EnergyAccumulator, count, 48);
AT(EnergyAccumulator, lines, 56);
SIZE(EnergyTracker, 176);
AT(EnergyTracker, energies, 24);
AT(EnergyTracker, names, 88);
AT(EnergyTracker, resetStep, 136);

SIZE(Cell, 1104);
AT(Cell, _invTrsf, 24);
AT(Cell, _trsfInc, 96);
AT(Cell, _vGradTimesPrevH, 168);
AT(Cell, _size, 240);
AT(Cell, _cos, 264);
AT(Cell, _refSize, 288);
AT(Cell, _hasShear, 312);
AT(Cell, _shearTrsf, 320);
AT(Cell, _unshearTrsf, 392);
AT(Cell, _glShearTrsfMatrix, 464);
AT(Cell, trsf, 592);
AT(Cell, refHSize, 664);
AT(Cell, hSize, 736);
AT(Cell, prevHSize, 808);
AT(Cell, velGrad, 880);
AT(Cell, nextVelGrad, 952);
AT(Cell, prevVelGrad, 1024);
AT(Cell, homoDeform, 1096);
AT(Cell, velGradChanged, 1100);
AT(Cell, flipFlippable, 1101);

SIZE(Scene, 752);
AT(Scene, allBits, 24);
AT(Scene, forces, 32);
AT(Scene, speedElements, 336);
AT(Scene, renderer, 416);
AT(Scene, prevTime, 432);
AT(Scene, dt, 440);
AT(Scene, iter, 448);
AT(Scene, subStepping, 456);
AT(Scene, subStep, 460);
AT(Scene, time, 464);
AT(Scene, speed, 472);
AT(Scene, stopAtIter, 480);
AT(Scene, stopAtTime, 488);
AT(Scene, isPeriodic, 496);
AT(Scene, trackEnergy, 497);
AT(Scene, doSort, 498);
AT(Scene, runInternalConsistencyChecks, 499);
AT(Scene, selectedBody, 500);
AT(Scene, subdomain, 504);
AT(Scene, subD, 512);
AT(Scene, tags, 528);
AT(Scene, engines, 552);
AT(Scene, _nextEngines, 576);
AT(Scene, bodies, 600);
AT(Scene, interactions, 616);
AT(Scene, energy, 632);
AT(Scene, materials, 648);
AT(Scene, bound, 672);
AT(Scene, cell, 688);
AT(Scene, miscParams, 704);
AT(Scene, dispParams, 728);

SIZE(Functor, 80);
AT(Functor, timingDeltas, 24);
AT(Functor, scene, 40);
AT(Functor, label, 48);
SIZE(BoundFunctor, 88);
SIZE(IGeomFunctor, 88);
SIZE(IPhysFunctor, 88);
SIZE(LawFunctor, 88);
SIZE(GlShapeFunctor, 88);
SIZE(GlIGeomFunctor, 88);
SIZE(GlIPhysFunctor, 88);
SIZE(GLViewInfo, 32);

} // namespace yade
