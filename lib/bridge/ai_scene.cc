#include "bridge/ai_scene.h"

#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <assimp/GltfMaterial.h>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

extern "C" {
#include "base/file.h"
#include "base/mem.h"
}

namespace {

const size_t FILE_MAX = (size_t)1 << 30;

template <class T> T *array(size_t n) { return (T *)mem_new(n + 1, sizeof(T)); }

/* A name inside of the folder for one that a file gives: artists' files have paths of the machine they were made on. */
std::string inside(const std::string &name)
{
	std::string s = name;
	for (char &c : s)
		c = c == '\\' ? '/' : c;
	while (s.rfind("./", 0) == 0)
		s = s.substr(2);
	const bool drive = s.size() > 1 && s[1] == ':';
	return drive || !file_is_relative(s.c_str()) ? s.substr(s.find_last_of('/') + 1) : s;
}

/* A file's bytes; freed with the last that holds them. */
struct Bytes {
	std::shared_ptr<char> data;
	size_t size = 0;
};

bool load(Bytes &out, const std::string &folder, const std::string &name, size_t most, struct err *err)
{
	char *path = nullptr, *data = nullptr;
	const std::string rel = inside(name);
	const bool ok = file_inside(&path, folder.c_str(), rel.c_str(), err) && file_read(&data, &out.size, path, most, err);
	out.data = std::shared_ptr<char>(data, free);
	free(path);
	return ok;
}

/* A file that is open. */
class Opened : public Assimp::MemoryIOStream {
public:
	explicit Opened(const Bytes &bytes) : MemoryIOStream((const uint8_t *)bytes.data.get(), bytes.size, false), bytes_(bytes) {}

private:
	Bytes bytes_;
};

/* The files that Assimp may open: those of one folder, in memory, for reading. It opens one again and again to find out what it is: the
 * last is kept. */
class Folder : public Assimp::IOSystem {
public:
	explicit Folder(const struct ai_file *file) : folder_(file->folder), given_(file) {}
	bool Exists(const char *name) const override
	{
		if (is_given(name))
			return true;
		struct err none = {};
		char *path = nullptr;
		const bool there = file_inside(&path, folder_.c_str(), inside(name).c_str(), &none);
		free(path);
		return there;
	}
	char getOsSeparator() const override { return '/'; }
	Assimp::IOStream *Open(const char *name, const char *mode) override
	{
		struct err none = {};
		if (strpbrk(mode, "wa+"))
			return nullptr;
		if (is_given(name))
			return new Assimp::MemoryIOStream((const uint8_t *)given_->bytes, given_->size, false);
		if (!last_.data || last_name_ != name) {
			last_ = {};
			Bytes bytes;
			if (!load(bytes, folder_, name, FILE_MAX, &none))
				return nullptr;
			last_ = bytes;
			last_name_ = name;
		}
		return new Opened(last_);
	}
	void Close(Assimp::IOStream *stream) override { delete stream; }

private:
	bool is_given(const char *name) const { return given_->bytes && inside(name) == given_->name; }
	std::string folder_, last_name_;
	const struct ai_file *given_;
	Bytes last_;
};

struct Reader {
	const aiScene *from;
	std::string folder;
	size_t texture_bytes;
	std::vector<struct ai_part> parts;
	std::vector<struct ai_texture> textures;
	std::map<std::string, int> texture_of;
	std::map<std::string, aiMatrix4x4> place;  // of nodes by name
	long vertices = 0, faces = 0, limit = 0;
	int depth = 0, node = 0;
};

void collect_nodes(Reader &r, const aiNode *node, const aiMatrix4x4 &above)
{
	const aiMatrix4x4 here = above * node->mTransformation;
	r.place.emplace(node->mName.C_Str(), here);
	for (unsigned i = 0; i < node->mNumChildren; i++)
		collect_nodes(r, node->mChildren[i], here);
}

/* The matrix that takes each vertex to its place: its node's, or the mean of its bones'. */
std::vector<aiMatrix4x4> places(const Reader &r, const aiMesh *mesh, const aiMatrix4x4 &node)
{
	std::vector<aiMatrix4x4> at(mesh->mNumVertices, node);
	if (!mesh->HasBones())
		return at;
	std::vector<float> sum(mesh->mNumVertices, 0);
	std::vector<aiMatrix4x4> mean(mesh->mNumVertices, aiMatrix4x4() * 0.0f);
	for (unsigned b = 0; b < mesh->mNumBones; b++) {
		const aiBone *bone = mesh->mBones[b];
		const auto joint = r.place.find(bone->mName.C_Str());
		if (joint == r.place.end())
			continue;
		const aiMatrix4x4 m = joint->second * bone->mOffsetMatrix;
		for (unsigned k = 0; k < bone->mNumWeights; k++) {
			const aiVertexWeight &w = bone->mWeights[k];
			if (w.mVertexId >= mesh->mNumVertices || !(w.mWeight > 0))
				continue;
			mean[w.mVertexId] = mean[w.mVertexId] + m * w.mWeight;
			sum[w.mVertexId] += w.mWeight;
		}
	}
	for (unsigned i = 0; i < mesh->mNumVertices; i++)
		if (sum[i] > 1e-6f)
			at[i] = mean[i] * (1 / sum[i]);
	return at;
}

void put(float out[3], const aiVector3D &v)
{
	out[0] = v.x;
	out[1] = v.y;
	out[2] = v.z;
}

/* rows: of the mesh, those that p has. */
void put_shapes(struct ai_part &p, const aiMesh *mesh, const std::vector<aiMatrix4x4> &at, const std::vector<unsigned> &rows)
{
	p.shape = array<struct ai_shape>(mesh->mNumAnimMeshes);
	for (unsigned s = 0; s < mesh->mNumAnimMeshes; s++) {
		const aiAnimMesh *shape = mesh->mAnimMeshes[s];
		if (!shape->HasPositions() || shape->mNumVertices != mesh->mNumVertices)
			continue;
		struct ai_shape &to = p.shape[p.n_shapes++];
		to.name = mem_str(shape->mName.length ? shape->mName.C_Str() : ("shape_" + std::to_string(s + 1)).c_str());
		to.by = (float(*)[3])array<float>(3 * rows.size());
		for (size_t i = 0; i < rows.size(); i++)
			put(to.by[i], aiMatrix3x3(at[rows[i]]) * (shape->mVertices[rows[i]] - mesh->mVertices[rows[i]]));
	}
}

/* The triangles; rows: out, the vertices that they have, in their order: primitives of one mesh may share all of them. */
bool put_faces(struct ai_part &p, std::vector<unsigned> &rows, const aiMesh *mesh, bool mirrored, struct err *err)
{
	std::vector<int32_t> to(mesh->mNumVertices, -1);
	p.face = (int32_t(*)[3])array<int32_t>(3 * (size_t)mesh->mNumFaces);
	for (unsigned f = 0; f < mesh->mNumFaces; f++) {
		const aiFace &face = mesh->mFaces[f];
		if (face.mNumIndices != 3)
			continue;
		for (unsigned k = 0; k < 3; k++) {
			const unsigned v = face.mIndices[mirrored ? 2 - k : k];
			if (v >= mesh->mNumVertices)
				return err_set(err, "a face has vertex %u, of %u", v, mesh->mNumVertices);
			to[v] = 0;
			p.face[p.n_faces][k] = (int32_t)v;
		}
		p.n_faces++;
	}
	for (unsigned v = 0; v < mesh->mNumVertices; v++)
		if (to[v] == 0) {
			to[v] = (int32_t)rows.size();
			rows.push_back(v);
		}
	for (int f = 0; f < p.n_faces; f++)
		for (int k = 0; k < 3; k++)
			p.face[f][k] = to[(size_t)p.face[f][k]];
	return true;
}

bool put_part(Reader &r, const aiMesh *mesh, const aiNode *node, const aiMatrix4x4 &here, struct err *err)
{
	struct ai_part p = {};
	std::vector<unsigned> rows;
	if (!put_faces(p, rows, mesh, here.Determinant() < 0, err))
		return false;
	const size_t n = rows.size();
	r.vertices += (long)n;
	r.faces += mesh->mNumFaces;
	if (r.vertices > 3 * r.limit || r.faces > 2 * r.limit)
		return err_set(err, "more than %ld vertices or faces", r.limit);
	const std::vector<aiMatrix4x4> at = places(r, mesh, here);
	p.name = mem_str(node->mName.length ? node->mName.C_Str() : mesh->mName.C_Str());
	p.n = (int)n;
	p.node = r.node;
	p.material = (int)mesh->mMaterialIndex;
	p.x = (float(*)[3])array<float>(3 * n);
	p.normal = mesh->HasNormals() ? (float(*)[3])array<float>(3 * n) : nullptr;
	p.uv = mesh->HasTextureCoords(0) ? (float(*)[2])array<float>(2 * n) : nullptr;
	p.rgba = mesh->HasVertexColors(0) ? (float(*)[4])array<float>(4 * n) : nullptr;
	for (size_t i = 0; i < n; i++) {
		const unsigned v = rows[i];
		put(p.x[i], at[v] * mesh->mVertices[v]);
		if (p.normal) {
			aiMatrix3x3 turn(at[v]);
			turn.Inverse().Transpose();
			put(p.normal[i], (turn * mesh->mNormals[v]).NormalizeSafe());
		}
		if (p.uv) {
			p.uv[i][0] = mesh->mTextureCoords[0][v].x;
			p.uv[i][1] = 1 - mesh->mTextureCoords[0][v].y;  // Assimp's v counts upwards
		}
		for (int c = 0; p.rgba && c < 4; c++)
			p.rgba[i][c] = mesh->mColors[0][v][(unsigned)c];
	}
	put_shapes(p, mesh, at, rows);
	if (p.n_faces)
		r.parts.push_back(p);
	return true;
}

bool put_parts(Reader &r, const aiNode *node, const aiMatrix4x4 &above, struct err *err)
{
	const aiMatrix4x4 here = above * node->mTransformation;
	r.node++;
	for (unsigned i = 0; i < node->mNumMeshes; i++)
		if (node->mMeshes[i] >= r.from->mNumMeshes || !put_part(r, r.from->mMeshes[node->mMeshes[i]], node, here, err))
			return err_set(err, "a node has a mesh that is not there");
	for (unsigned i = 0; i < node->mNumChildren; i++)
		if (!put_parts(r, node->mChildren[i], here, err))
			return false;
	return true;
}

int texture(Reader &r, const aiMaterial *m, aiTextureType type)
{
	aiString path;
	if (m->GetTextureCount(type) == 0 || m->GetTexture(type, 0, &path) != AI_SUCCESS || !path.length)
		return -1;
	const auto known = r.texture_of.find(path.C_Str());
	if (known != r.texture_of.end())
		return known->second;
	struct ai_texture t = {};
	const aiTexture *inner = r.from->GetEmbeddedTexture(path.C_Str());
	t.name = mem_str(inner && inner->mFilename.length ? inner->mFilename.C_Str() : path.C_Str());
	Bytes file;
	const void *bytes = nullptr;
	struct err why = {};
	if (inner && inner->mHeight)
		err_set(&why, "raw pixels");
	else if (inner && inner->mWidth > r.texture_bytes)
		err_set(&why, "more than %zu MiB", r.texture_bytes >> 20);
	else if (inner) {
		bytes = inner->pcData;
		t.size = inner->mWidth;
	} else if (load(file, r.folder, path.C_Str(), r.texture_bytes, &why)) {
		bytes = file.data.get();
		t.size = file.size;
	}
	if (err_is(&why))
		t.why = mem_str(why.msg);
	else {
		t.bytes = array<unsigned char>(t.size);
		memcpy(t.bytes, bytes, t.size);
	}
	r.textures.push_back(t);
	return r.texture_of[path.C_Str()] = (int)r.textures.size() - 1;
}

int first_of(int a, int b) { return a >= 0 ? a : b; }

float real(const aiMaterial *m, const char *key, unsigned type, unsigned index, float otherwise)
{
	ai_real x = otherwise;
	return m->Get(key, type, index, x) == AI_SUCCESS && std::isfinite(x) ? (float)x : otherwise;
}

void put_material(struct ai_material &out, Reader &r, const aiMaterial *m)
{
	aiString text;
	aiColor4D colour(1, 1, 1, 1);
	aiColor3D glow(0, 0, 0);
	int two_sided = 0;
	out.name = mem_str(m->Get(AI_MATKEY_NAME, text) == AI_SUCCESS ? text.C_Str() : "");
	if (m->Get(AI_MATKEY_BASE_COLOR, colour) != AI_SUCCESS)
		m->Get(AI_MATKEY_COLOR_DIFFUSE, colour);
	m->Get(AI_MATKEY_COLOR_EMISSIVE, glow);
	m->Get(AI_MATKEY_TWOSIDED, two_sided);
	for (unsigned c = 0; c < 4; c++)
		out.rgba[c] = std::isfinite(colour[c]) ? std::fmin(std::fmax(colour[c], 0.0f), 1.0f) : 1;
	for (unsigned c = 0; c < 3; c++)
		out.emissive[c] = std::isfinite(glow[c]) ? std::fmin(std::fmax(glow[c], 0.0f), 1.0f) : 0;
	out.rough = std::fmin(std::fmax(real(m, AI_MATKEY_ROUGHNESS_FACTOR, 0.6f), 0.0f), 1.0f);
	out.metal = std::fmin(std::fmax(real(m, AI_MATKEY_METALLIC_FACTOR, 0.0f), 0.0f), 1.0f);
	out.cutoff = std::fmin(std::fmax(real(m, AI_MATKEY_GLTF_ALPHACUTOFF, 0.5f), 0.0f), 1.0f);
	out.normal_scale = real(m, AI_MATKEY_GLTF_TEXTURE_SCALE(aiTextureType_NORMALS, 0), 1.0f);
	out.two_sided = two_sided != 0;
	if (m->Get(AI_MATKEY_GLTF_ALPHAMODE, text) == AI_SUCCESS)
		out.alpha = !strcmp(text.C_Str(), "MASK") ? 1 : !strcmp(text.C_Str(), "BLEND") ? 2 : 0;
	else
		out.alpha = m->GetTextureCount(aiTextureType_OPACITY) ? 1 : out.rgba[3] < 1 ? 2 : 0;
	out.map[AI_COLOUR] = first_of(texture(r, m, aiTextureType_BASE_COLOR), texture(r, m, aiTextureType_DIFFUSE));
	out.map[AI_NORMAL] = first_of(texture(r, m, aiTextureType_NORMALS), texture(r, m, aiTextureType_NORMAL_CAMERA));
	out.map[AI_METAL] = texture(r, m, aiTextureType_UNKNOWN);  // glTF's; that of others stands alone
	out.map[AI_METAL] = first_of(out.map[AI_METAL], texture(r, m, aiTextureType_DIFFUSE_ROUGHNESS));
	out.map[AI_EMISSIVE] = texture(r, m, aiTextureType_EMISSIVE);
	out.map[AI_OCCLUSION] = texture(r, m, aiTextureType_LIGHTMAP);
}

template <class T> T *kept(const std::vector<T> &v)
{
	T *out = array<T>(v.size());
	std::copy(v.begin(), v.end(), out);
	return out;
}

}  // namespace

bool ai_scene_read(struct ai_scene *scene, const struct ai_file *file, long limit, size_t texture_bytes, struct err *err)
{
	*scene = {};
	try {
		Assimp::Importer importer;
		importer.SetIOHandler(new Folder(file));
		importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
		importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
		Reader r = {};
		r.from = importer.ReadFile(file->name, aiProcess_Triangulate | aiProcess_SortByPType);
		r.folder = file->folder;
		r.texture_bytes = texture_bytes;
		r.limit = limit;
		if (!r.from || !r.from->mRootNode)
			return err_set(err, "cannot be read: %.300s", importer.GetErrorString());
		collect_nodes(r, r.from->mRootNode, aiMatrix4x4());
		if (!put_parts(r, r.from->mRootNode, aiMatrix4x4(), err))
			return false;
		scene->n_materials = (int)r.from->mNumMaterials;
		scene->material = array<struct ai_material>(r.from->mNumMaterials);
		for (unsigned i = 0; i < r.from->mNumMaterials; i++)
			put_material(scene->material[i], r, r.from->mMaterials[i]);
		scene->n_parts = (int)r.parts.size();
		scene->part = kept(r.parts);
		scene->n_textures = (int)r.textures.size();
		scene->texture = kept(r.textures);
		return scene->n_parts > 0 || err_set(err, "has no faces");
	} catch (const std::exception &e) {
		return err_set(err, "cannot be read: %.300s", e.what());
	} catch (...) {
		return err_set(err, "cannot be read");
	}
}
