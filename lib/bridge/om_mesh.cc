#include "bridge/om_mesh.h"

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

// gcc 12 warns of an uninitialised allocator, which has no members, in OpenMesh's property vectors.
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

extern "C" {
#include "base/file.h"
#include "base/mem.h"
#include "image/image.h"
#include "mesh/mesh_clean.h"
#include "mesh/mesh_joins.h"
}

namespace {

struct Traits : OpenMesh::DefaultTraits {
	typedef OpenMesh::Vec3f Color;  // as struct mesh has them
	VertexAttributes(OpenMesh::Attributes::Status | OpenMesh::Attributes::Color);
	FaceAttributes(OpenMesh::Attributes::Status);
	EdgeAttributes(OpenMesh::Attributes::Status);
	HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
};
using Mesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;

/* Silences OpenMesh, which prints faces it cannot join to std::cerr; errors are returned in struct err. */
void be_quiet()
{
	omlog().disable();
	omout().disable();
	omerr().disable();
}

/* Adds a triangle; one that would give an edge a third face gets vertices of its own, appended behind all others. Returns whether it
 * was added; from: where not null, what each such vertex is a copy of is appended. */
bool add_triangle(Mesh &om, const Mesh::VertexHandle corner[3], std::vector<int32_t> *from = nullptr)
{
	if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0])
		return false;
	if (om.add_face(corner[0], corner[1], corner[2]).is_valid())
		return true;
	Mesh::VertexHandle own[3];
	for (int k = 0; k < 3; k++) {
		const Mesh::Point at = om.point(corner[k]);  // copies: what they are taken from moves as it grows
		const Mesh::Color colour = om.color(corner[k]);
		own[k] = om.add_vertex(at);
		om.set_color(own[k], colour);
		if (from)
			from->push_back(corner[k].idx());
	}
	return om.add_face(own[0], own[1], own[2]).is_valid();
}

/* Converts from OpenMesh. Colours stay in sRGB. */
void take(struct mesh *mesh, const Mesh &om, bool colours)
{
	mesh->n_vertices = (int)om.n_vertices();
	mesh->n_faces = (int)om.n_faces();
	mesh->vertices = (float (*)[3])mem_array(om.n_vertices(), 3 * sizeof(float));
	mesh->faces = (int32_t (*)[3])mem_array(om.n_faces(), 3 * sizeof(int32_t));
	mesh->colours = colours ? (float (*)[3])mem_array(om.n_vertices(), 3 * sizeof(float)) : nullptr;
	for (int i = 0; i < mesh->n_vertices; i++) {
		auto v = om.vertex_handle((unsigned)i);
		for (size_t k = 0; k < 3; k++) {
			mesh->vertices[i][k] = om.point(v)[k];
			if (colours)
				mesh->colours[i][k] = om.color(v)[k];
		}
	}
	for (int i = 0; i < mesh->n_faces; i++) {
		int k = 0;
		for (auto v : om.fv_range(om.face_handle((unsigned)i)))
			mesh->faces[i][k++] = v.idx();
	}
}

struct Origin {
	std::vector<int32_t> vertex, face;
};

bool give(Mesh &om, const struct mesh *mesh, struct err *err, Origin *origin = nullptr)
{
	if (!mesh_joins_check(mesh, err))
		return false;
	for (int i = 0; i < mesh->n_vertices; i++) {
		const float *p = mesh->vertices[i];
		auto v = om.add_vertex(Mesh::Point(p[0], p[1], p[2]));
		Mesh::Color colour(0, 0, 0);
		for (int k = 0; mesh->colours && k < 3; k++)
			colour[(size_t)k] = mesh->colours[i][k];
		om.set_color(v, colour);
		if (origin)
			origin->vertex.push_back(i);
	}
	for (int i = 0; i < mesh->n_faces; i++) {
		Mesh::VertexHandle corner[3];
		for (int k = 0; k < 3; k++)
			corner[k] = om.vertex_handle((unsigned)mesh->faces[i][k]);
		if (add_triangle(om, corner, origin ? &origin->vertex : nullptr) && origin)
			origin->face.push_back(i);
	}
	return true;
}

/* Replaces the mesh by OpenMesh's. */
void replace(struct mesh *mesh, const Mesh &om)
{
	struct mesh made = {};
	take(&made, om, mesh->colours != nullptr);
	mesh_free(mesh);
	*mesh = made;
}

/* Splits edges of three faces and fans that share one vertex, by OpenMesh; a manifold mesh stays as it is. */
bool make_sound(struct mesh *mesh, struct err *err)
{
	if (mesh_joins_sound(mesh))
		return true;
	Mesh om;
	be_quiet();
	if (!give(om, mesh, err))
		return false;
	replace(mesh, om);
	return true;
}

}  // namespace

bool om_mesh_load(struct mesh *mesh, const char *path, long limit, struct err *err)
{
	enum { BYTES_EACH = 256, BYTES_HEAD = 1 << 16 };
	*mesh = {};
	struct err why = {};
	char *data;
	size_t size;
	if (!file_read(&data, &size, path, (size_t)limit * 2 * BYTES_EACH + BYTES_HEAD, err))
		return false;
	bool ok = false;
	try {
		ok = mesh_clean(mesh, data, size, limit, &why) && mesh_check(mesh, &why) && make_sound(mesh, &why);
	} catch (const std::exception &e) {
		err_set(&why, "cannot be read: %s", e.what());
	} catch (...) {
		err_set(&why, "cannot be read");
	}
	free(data);
	for (int i = 0; ok && mesh->colours && i < mesh->n_vertices; i++)
		for (float &c : mesh->colours[i])
			c = linear_from_srgb(c);
	if (ok)
		return true;
	mesh_free(mesh);
	return err_set(err, "%s: %s", path, why.msg);
}

bool om_mesh_save(const struct mesh *mesh, const char *path, const char *made_by, struct err *err)
{
	try {
		// Written here and not by OpenMesh: its writer has no comments, and would split faces that share an edge
		// with two others.
		std::string out = "ply\nformat binary_little_endian 1.0\n";
		if (made_by) {
			std::string comment = made_by;
			for (char &c : comment)
				c = c == '\n' || c == '\r' ? ' ' : c;
			out += "comment made_by " + comment + "\n";
		}
		out += "element vertex " + std::to_string(mesh->n_vertices) + "\n";
		out += "property float x\nproperty float y\nproperty float z\n";
		if (mesh->colours)
			out += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
		out += "element face " + std::to_string(mesh->n_faces) + "\nproperty list uchar int vertex_indices\nend_header\n";
		static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "values go out as they lie in memory");
		for (int i = 0; i < mesh->n_vertices; i++) {
			out.append((const char *)mesh->vertices[i], 3 * sizeof(float));
			for (int k = 0; mesh->colours && k < 3; k++)
				out += (char)(unsigned char)std::lround(255 * srgb_from_linear(mesh->colours[i][k]));
		}
		for (int i = 0; i < mesh->n_faces; i++) {
			out += (char)3;
			out.append((const char *)mesh->faces[i], 3 * sizeof(int32_t));
		}
		return file_write(path, out.data(), out.size(), err);
	} catch (...) {
		return err_set(err, "%s: out of memory", path);
	}
}

bool om_mesh_decimate(struct mesh *mesh, int target_faces, struct err *err)
{
	try {
		Mesh om;
		be_quiet();
		if (!give(om, mesh, err))
			return false;
		OpenMesh::Decimater::DecimaterT<Mesh> decimater(om);
		OpenMesh::Decimater::ModQuadricT<Mesh>::Handle quadric;
		decimater.add(quadric);
		decimater.module(quadric).unset_max_err();
		if (!decimater.initialize())
			return err_set(err, "decimation: OpenMesh refused the mesh");
		decimater.decimate_to_faces(0, (size_t)target_faces);
		om.garbage_collection();
		if ((int)om.n_faces() > target_faces)
			return err_set(err, "decimation: stopped at %zu faces, must be <= %d", om.n_faces(), target_faces);
		replace(mesh, om);
		return true;
	} catch (...) {
		return err_set(err, "decimation: out of memory");
	}
}

static int32_t *copied(const std::vector<int32_t> &from)
{
	auto *out = (int32_t *)mem_new(from.size() + 1, sizeof(int32_t));
	memcpy(out, from.data(), from.size() * sizeof *out);
	return out;
}

bool om_mesh_sound(struct mesh *mesh, int32_t **vertex_from, int32_t **face_from, struct err *err)
{
	*vertex_from = *face_from = nullptr;
	try {
		Mesh om;
		Origin origin;
		be_quiet();
		if (!give(om, mesh, err, &origin))
			return false;
		replace(mesh, om);
		*vertex_from = copied(origin.vertex);
		*face_from = copied(origin.face);
		return true;
	} catch (...) {
		return err_set(err, "out of memory");
	}
}
