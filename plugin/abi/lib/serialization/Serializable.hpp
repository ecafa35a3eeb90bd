// The root of YADE's classes, and the macros by which a plugin class describes itself. They have the names and the
// argument order of YADE's own, so a class written with them compiles against a YADE source tree as well.
//
// How to write a class, in BlockMat.hpp:
//     class BlockMat : public FrictMat {
//     public:
//         void postLoad(BlockMat&);      // optional: called after keyword construction, loading, and the assignment of
//                                        // an attribute flagged Attr::triggerPostLoad; throws std::invalid_argument
//         YADE_CLASS_BASE_DOC_ATTRS_CTOR(BlockMat, FrictMat, "What it is.",
//             ((Real, restitution, NaN, Attr::triggerPostLoad, "Meaning, unit, range."))   // flags may be left empty
//             ((vector<int>, ids, , , "...")),
//             createIndex(););           // in State, Shape, Material, Bound, IGeom, IPhys and what derives from them
//         REGISTER_CLASS_INDEX(BlockMat, FrictMat);                                        // in the same families
//     };
//     REGISTER_SERIALIZABLE(BlockMat);   // inside namespace yade
// and in BlockMat.cpp, which includes <lib/factory/ClassFactory.hpp>, inside namespace yade:
//     YADE_PLUGIN((BlockMat));           // Python class, archives and registration are compiled here only
// One class a file; its base must be a YADE class or live in another file. Types of attributes: those that YADE
// converts to Python and archives (numbers, string, Vector3r, Quaternionr, Se3r, vectors of int, bool, Real, string,
// Vector3r, shared_ptr to a YADE class). Types with a comma need an alias.
#pragma once

#include <boost/preprocessor.hpp>
#include <boost/python/dict.hpp>
#include <boost/python/object.hpp>
#include <boost/python/tuple.hpp>
#include <boost/serialization/access.hpp>
#include <boost/serialization/base_object.hpp>
#include <boost/serialization/nvp.hpp>

#include <declare.hpp>
#include <lib/base/Logging.hpp>
#include <lib/factory/Factorable.hpp>

namespace yade {

namespace Attr {
/// noSave: not archived. readonly: Python cannot assign it. hidden: not seen by Python at all (nor by pickle).
/// triggerPostLoad: assignment from Python ends in postLoad.
enum flags { noSave = 1, readonly = 2, triggerPostLoad = 4, hidden = 8, noResize = 16 };
} // namespace Attr

class Serializable : public Factorable {
public:
	Serializable() = default;
	~Serializable() override;
	string getBaseClassName(unsigned i = 0) const override;
	int getBaseClassNumber() const override;
	string getClassName() const override;
	virtual void pySetAttr(const string& name, const boost::python::object& value);
	virtual boost::python::dict pyDict() const;
	virtual boost::python::dict pyDictCustom() const;
	virtual void callPostLoad();
	virtual void checkPyClassRegistersItself(const string& className) const;
	virtual void pyRegisterClass(boost::python::object scope);
	virtual void pyHandleCustomCtorArgs(boost::python::tuple& args, boost::python::dict& keywords);

	void pyUpdateAttrs(const boost::python::dict& attributes);
};

/// Does nothing: what a class without a postLoad of its own gets.
template <class T>
void postLoad(T&)
{
}

namespace abi {
/// One attribute, as handed to the visitors of plugin_class.hpp. The flags are part of the type: what is not saved
/// needs no archive, and what is hidden no converter.
template <class Class, class T, int Flags>
struct Attribute {
	static constexpr int flags = Flags;
	const char* name;
	T Class::*member;
	const char* doc;
};
template <int Flags, class Class, class T>
Attribute<Class, T, Flags> attribute(const char* name, T Class::*member, const char* doc)
{
	return {name, member, doc};
}
template <class T>
struct Identity {
	using type = T;
};
} // namespace abi

} // namespace yade

YADE_ABI_ARCHIVED(Serializable)

// Parts of an attribute: (type, name, default, flags, doc).
#define YADE_ABI_TYPE(attr) BOOST_PP_TUPLE_ELEM(0, attr)
#define YADE_ABI_NAME(attr) BOOST_PP_TUPLE_ELEM(1, attr)
#define YADE_ABI_DEFAULT(attr) BOOST_PP_TUPLE_ELEM(2, attr)
#define YADE_ABI_FLAGS(attr) (BOOST_PP_TUPLE_ELEM(3, attr) + 0)
#define YADE_ABI_DOC(attr) BOOST_PP_TUPLE_ELEM(4, attr)

#define YADE_ABI_MEMBER(r, data, attr)                                                                                                     \
	YADE_ABI_TYPE(attr) YADE_ABI_NAME(attr) = yade::abi::Identity<YADE_ABI_TYPE(attr)>::type(YADE_ABI_DEFAULT(attr));
// The marks at the end of the text are read by YADE's object editor, to know what an empty list may hold.
#define YADE_ABI_FULL_DOC(attr)                                                                                                            \
	YADE_ABI_DOC(attr)                                                                                                                     \
	" :ydefault:`" BOOST_PP_STRINGIZE(YADE_ABI_DEFAULT(attr)) "` :yattrtype:`" BOOST_PP_STRINGIZE(YADE_ABI_TYPE(attr)) "`"
#define YADE_ABI_VISIT(r, Class, attr)                                                                                                     \
	visit(yade::abi::attribute<YADE_ABI_FLAGS(attr)>(BOOST_PP_STRINGIZE(YADE_ABI_NAME(attr)), &Class::YADE_ABI_NAME(attr),                 \
	                                                                    YADE_ABI_FULL_DOC(attr)));
#define YADE_ABI_INITIALIZER(r, data, i, pair)                                                                                             \
	BOOST_PP_IF(i, BOOST_PP_COMMA, BOOST_PP_EMPTY)() BOOST_PP_TUPLE_ELEM(0, pair)(BOOST_PP_TUPLE_ELEM(1, pair))
#define YADE_ABI_INITIALIZERS(inits) BOOST_PP_EXPR_IF(BOOST_PP_SEQ_SIZE(inits), :) BOOST_PP_SEQ_FOR_EACH_I(YADE_ABI_INITIALIZER, ~, inits)

#define YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(Class, Base, docText, attrs, inits, ctor, py)                                               \
public:                                                                                                                                    \
	BOOST_PP_SEQ_FOR_EACH(YADE_ABI_MEMBER, ~, attrs)                                                                                       \
	Class() YADE_ABI_INITIALIZERS(inits) { ctor; }                                                                                         \
	string getBaseClassName(unsigned i = 0) const override;                                                                                \
	int getBaseClassNumber() const override;                                                                                               \
	string getClassName() const override;                                                                                                  \
	void pySetAttr(const string& name, const ::boost::python::object& value) override;                                                     \
	::boost::python::dict pyDict() const override;                                                                                         \
	void callPostLoad() override;                                                                                                          \
	void pyRegisterClass(::boost::python::object scope) override;                                                                          \
                                                                                                                                           \
	struct AbiTraits {                                                                                                                     \
		using BaseClass = Base;                                                                                                            \
		static const char* name() { return #Class; }                                                                                       \
		static const char* baseName() { return #Base; }                                                                                    \
		static const char* doc() { return docText; }                                                                                       \
		template <class Visitor>                                                                                                           \
		static void attributes(Visitor& visit)                                                                                             \
		{                                                                                                                                  \
			(void)visit;                                                                                                                   \
			BOOST_PP_SEQ_FOR_EACH(YADE_ABI_VISIT, Class, attrs)                                                                            \
		}                                                                                                                                  \
		template <class PythonClass>                                                                                                       \
		static void extras(PythonClass& pythonClass)                                                                                       \
		{                                                                                                                                  \
			(void)pythonClass py;                                                                                                          \
		}                                                                                                                                  \
	};                                                                                                                                     \
	void abiPostLoad() { postLoad(*this); }                                                                                                \
                                                                                                                                           \
private:                                                                                                                                   \
	friend class ::boost::serialization::access;                                                                                           \
	template <class Archive>                                                                                                               \
	void serialize(Archive& archive, unsigned)                                                                                             \
	{                                                                                                                                      \
		yade::abi::archiveObject<Archive, Class>(archive, *this);                                                                          \
	}                                                                                                                                      \
                                                                                                                                           \
public:

#define YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(Class, Base, doc, attrs, ctor, py)                                                               \
	YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(Class, Base, doc, attrs, , ctor, py)
#define YADE_CLASS_BASE_DOC_ATTRS_CTOR(Class, Base, doc, attrs, ctor)                                                                      \
	YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(Class, Base, doc, attrs, , ctor, )
#define YADE_CLASS_BASE_DOC_ATTRS(Class, Base, doc, attrs) YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(Class, Base, doc, attrs, , , )
#define YADE_CLASS_BASE_DOC(Class, Base, doc) YADE_CLASS_BASE_DOC_ATTRS_INIT_CTOR_PY(Class, Base, doc, , , , )

namespace yade {
namespace abi {
/// Writes or reads the base object and the attributes (plugin_class.hpp).
template <class Archive, class Class>
void archiveObject(Archive&, Class&);
} // namespace abi
} // namespace yade

/// Stands inside namespace yade, after the class; leaves and re-enters it, as the key belongs to Boost's namespace.
#define REGISTER_SERIALIZABLE(Class)                                                                                                       \
	}                                                                                                                                      \
	BOOST_CLASS_EXPORT_KEY(yade::Class)                                                                                                    \
	namespace yade {
