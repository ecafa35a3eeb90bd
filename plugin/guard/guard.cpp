#include <boost/python.hpp>
#include <cstring>
#include <dlfcn.h>
#include <link.h>

#include <core/Dispatching.hpp>
#include <core/InteractionLoop.hpp>
#include <core/Omega.hpp>
#include <core/PartialEngine.hpp>
#include <core/Scene.hpp>
#include <core/TimeStepper.hpp>
#include <guard.hpp>
#include <pkg/common/Box.hpp>
#include <pkg/common/ElastMat.hpp>
#include <pkg/common/MatchMaker.hpp>
#include <pkg/common/PeriodicEngines.hpp>
#include <pkg/dem/FrictPhys.hpp>
#include <pkg/dem/ScGeom.hpp>

namespace yade {
namespace guard {

namespace {
namespace python = ::boost::python;

string hex(const unsigned char* bytes, size_t count)
{
	static const char digits[] = "0123456789abcdef";
	string text;
	for (size_t i = 0; i < count; i++)
		text.append({digits[bytes[i] >> 4], digits[bytes[i] & 15]});
	return text;
}

/// The GNU build id among the notes of a loaded object: each note is a header, a name and the data, both padded
/// to four bytes.
string buildIdOf(const dl_phdr_info& object)
{
	for (int i = 0; i < object.dlpi_phnum; i++) {
		const ElfW(Phdr)& segment = object.dlpi_phdr[i];
		if (segment.p_type != PT_NOTE)
			continue;
		auto at = reinterpret_cast<const unsigned char*>(object.dlpi_addr + segment.p_vaddr);
		const auto end = at + segment.p_memsz;
		while (at + sizeof(ElfW(Nhdr)) <= end) {
			const auto& note = *reinterpret_cast<const ElfW(Nhdr)*>(at);
			const auto name = at + sizeof note, data = name + ((note.n_namesz + 3) & ~3u);
			if (note.n_type == NT_GNU_BUILD_ID && !std::memcmp(name, "GNU", 4))
				return hex(data, note.n_descsz);
			at = data + ((note.n_descsz + 3) & ~3u);
		}
	}
	return "";
}

/// Every class has an exported maker that begins by asking operator new for the object's size, in the register of the first argument: the
/// operand of the first instruction that puts a constant there. Zero when there is none.
size_t sizeInYade(const string& className)
{
	const string maker = "CreatePureCustom" + className;
	const string symbol = "_ZN4yade" + std::to_string(maker.size()) + maker + "Ev";
	auto code = static_cast<const unsigned char*>(dlsym(RTLD_DEFAULT, symbol.c_str()));
	if (!code)
		return 0;
	for (int i = 0; i < 64; i++) {
		unsigned word;
#ifdef __aarch64__
		if (i % 4)
			continue;
		std::memcpy(&word, code + i, sizeof word); // mov w0 or x0, 16 bits
		if ((word & 0x7FE0001F) == 0x52800000)
			return word >> 5 & 0xFFFF;
#else
		std::memcpy(&word, code + i + 1, sizeof word); // mov edi, 32 bits
		if (code[i] == 0xBF)
			return word;
#endif
	}
	return 0;
}

void require(bool fits, const char* what)
{
	if (!fits)
		throw std::runtime_error(string("its ") + what + " is laid out differently");
}

python::object make(const char* className) { return python::import("yade.wrapper").attr(className)(); }

template <class T>
T& in(const python::object& object)
{
	return python::extract<T&>(object)();
}

/// Values written through Python must be found by our declarations.
void requireMembers()
{
	python::object state = make("State");
	state.attr("vel") = Vector3r(1, 2, 3);
	state.attr("mass") = 4.5;
	state.attr("refPos") = Vector3r(6, 7, 8);
	state.attr("blockedDOFs") = "xZ";
	state.attr("densityScaling") = 9.5;
	const State& s = in<State>(state);
	require(&s.pos == &s.se3.position && &s.ori == &s.se3.orientation && s.vel == Vector3r(1, 2, 3) && s.mass == 4.5 &&
	            s.refPos == Vector3r(6, 7, 8) && s.blockedDOFs == (State::DOF_X | State::DOF_RZ) && s.densityScaling == 9.5,
	        "State");

	python::object box = make("Box"), material = make("FrictMat"), body = make("Body");
	box.attr("extents") = Vector3r(1, 2, 3);
	require(in<Box>(box).extents == Vector3r(1, 2, 3) && in<Box>(box).color == Vector3r(1, 1, 1), "Box");
	material.attr("density") = 11.;
	material.attr("young") = 12.;
	material.attr("frictionAngle") = 13.;
	const FrictMat& m = in<FrictMat>(material);
	require(m.density == 11 && m.young == 12 && m.frictionAngle == 13, "FrictMat");
	body.attr("shape") = box;
	body.attr("state") = state;
	body.attr("material") = material;
	body.attr("groupMask") = 14;
	const Body& b = in<Body>(body);
	require(b.shape.get() == &in<Box>(box) && b.state.get() == &s && b.material.get() == &m && b.groupMask == 14 && b.id == -1 &&
	            b.clumpId == -1,
	        "Body");

	const Scene& scene = *Omega::instance().getScene();
	python::object O = python::import("yade").attr("O");
	require(scene.dt == python::extract<Real>(O.attr("dt"))() && scene.iter == python::extract<long>(O.attr("iter"))() &&
	            scene.trackEnergy == python::extract<bool>(O.attr("trackEnergy"))() &&
	            scene.bodies->body.size() == size_t(python::len(O.attr("bodies"))) && scene.cell && scene.energy,
	        "Scene");
}

/// Calls through the virtual tables of YADE's own objects, from each table a plugin class derives from.
void requireVirtualFunctions()
{
	python::object material = make("FrictMat"), elastic = make("ElastMat"), geometry = make("Ig2_Sphere_Sphere_ScGeom"),
	               engine = make("ForceResetter");
	require(in<Material>(material).getClassName() == "FrictMat" && in<Material>(material).getBaseClassName(0) == "ElastMat" &&
	            in<Material>(material).getBaseClassIndex(1) == in<Material>(elastic).getClassIndex(),
	        "table of virtual functions of Material");
	const IGeomFunctor& functor = in<IGeomFunctor>(geometry);
	require(functor.getClassName() == "Ig2_Sphere_Sphere_ScGeom" && functor.getFunctorTypes().size() == 2 &&
	            functor.get2DFunctorType2() == "Sphere" && functor.checkOrder() == "Sphere Sphere",
	        "table of virtual functions of IGeomFunctor");
	require(in<Engine>(engine).getClassName() == "ForceResetter" && in<Engine>(engine).isActivated(),
	        "table of virtual functions of Engine");
}
} // namespace

Sizes compiledSizes()
{
#define SIZE(Class)                                                                                                                        \
	{                                                                                                                                      \
#Class, sizeof(Class)                                                                                                              \
	}
	return {SIZE(State),           SIZE(Body),
	        SIZE(Scene),           SIZE(Box),
	        SIZE(FrictMat),        SIZE(Aabb),
	        SIZE(ScGeom),          SIZE(FrictPhys),
	        SIZE(Interaction),     SIZE(InteractionContainer),
	        SIZE(BodyContainer),   SIZE(Cell),
	        SIZE(EnergyTracker),   SIZE(MatchMaker),
	        SIZE(GlobalEngine),    SIZE(PartialEngine),
	        SIZE(PeriodicEngine),  SIZE(TimeStepper),
	        SIZE(InteractionLoop), SIZE(IGeomFunctor),
	        SIZE(LawFunctor)};
#undef SIZE
}

void requireFit(const Sizes& needed)
{
	for (const auto& [name, size] : needed)
		if (const size_t found = sizeInYade(name); found != size)
			throw std::runtime_error("its " + name + " takes " + std::to_string(found) + " bytes instead of " + std::to_string(size));
	requireMembers();
	requireVirtualFunctions();
}

string loadedBuildId(const string& library)
{
	struct Search {
		string library, id;
	} search {library, ""};
	dl_iterate_phdr(
	    [](dl_phdr_info* object, size_t, void* data) {
		    auto& wanted = *static_cast<Search*>(data);
		    const char* file = std::strrchr(object->dlpi_name, '/');
		    if (!file || wanted.library != file + 1)
			    return 0;
		    wanted.id = buildIdOf(*object);
		    return 1;
	    },
	    &search);
	return search.id;
}

} // namespace guard
} // namespace yade
