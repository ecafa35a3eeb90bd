#pragma once

#include <lib/serialization/Serializable.hpp>

namespace yade {

/// Periodic cell. Shift of the second body of a pair: hSize * cellDist; of its velocity: _vGradTimesPrevH * cellDist.
class Cell : public Serializable {
	YADE_ABI_CLASS(Cell)
	Cell();

	const Vector3r& getSize() const { return _size; }
	bool hasShear() const { return _hasShear; }

	Matrix3r _invTrsf;
	Matrix3r _trsfInc;
	Matrix3r _vGradTimesPrevH;
	Vector3r _size;
	Vector3r _cos;
	Vector3r _refSize;
	bool _hasShear;
	Matrix3r _shearTrsf;
	Matrix3r _unshearTrsf;
	double _glShearTrsfMatrix[16];
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
};

} // namespace yade

YADE_ABI_ARCHIVED(Cell)
