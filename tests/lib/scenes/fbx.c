#include "tests/lib/scenes/fbx.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/picture.h"
#include "mesh/topology.h"

/* One piece (0: the head, else the rest) as a geometry of its own. Its vertices are all of the mesh: strangers' files have such, too. */
static void geometry(FILE *f, const struct mesh *m, const int32_t *piece, bool head, const struct dressed *how)
{
	int n = 0;
	float lo = INFINITY, hi = -INFINITY;
	fprintf(f, "Geometry: %d, \"Geometry::%s\", \"Mesh\" {\nVertices: *%d {\na: ", head ? 100 : 101, head ? "head" : "eyes", 3 * m->n_vertices);
	for (int i = 0; i < m->n_vertices; i++) {
		fprintf(f, "%s%.7g,%.7g,%.7g", i ? "," : "", how->unit * (double)m->vertices[i][0], how->unit * (double)m->vertices[i][1], how->unit * (double)m->vertices[i][2]);
		lo = fminf(lo, m->vertices[i][1]);
		hi = fmaxf(hi, m->vertices[i][1]);
	}
	for (int i = 0; i < m->n_faces; i++)
		n += (piece[m->faces[i][0]] == 0) == head;
	fprintf(f, "\n}\nPolygonVertexIndex: *%d {\na: ", 3 * n);
	for (int i = 0, k = 0; i < m->n_faces; i++)
		if ((piece[m->faces[i][0]] == 0) == head)
			fprintf(f, "%s%d,%d,%d", k++ ? "," : "", m->faces[i][0], m->faces[i][1], -m->faces[i][2] - 1);
	fprintf(f, "\n}\nGeometryVersion: 124\nLayerElementUV: 0 {\nVersion: 101\nName: \"map1\"\nMappingInformationType: \"ByPolygonVertex\"\n"
	           "ReferenceInformationType: \"Direct\"\nUV: *%d {\na: ", 6 * n);
	for (int i = 0, k = 0; i < m->n_faces; i++)
		for (int c = 0; c < 3 && (piece[m->faces[i][0]] == 0) == head; c++) {
			const float *x = m->vertices[m->faces[i][c]];
			fprintf(f, "%s%.6g,%.6g", k++ ? "," : "", 0.5 + atan2((double)x[0], (double)x[2]) / (2 * M_PI), (double)((x[1] - lo) / (hi - lo)));
		}
	fprintf(f, "\n}\n}\nLayerElementMaterial: 0 {\nVersion: 101\nName: \"\"\nMappingInformationType: \"AllSame\"\nReferenceInformationType: \"IndexToDirect\"\n"
	           "Materials: *1 {\na: 0\n}\n}\nLayer: 0 {\nVersion: 100\nLayerElement:  {\nType: \"LayerElementUV\"\nTypedIndex: 0\n}\n"
	           "LayerElement:  {\nType: \"LayerElementMaterial\"\nTypedIndex: 0\n}\n}\n}\n");
}

/* The chin goes down. */
static void shape(FILE *f, const struct mesh *m, const int32_t *piece, const struct dressed *how)
{
	float lo = INFINITY, hi = -INFINITY;
	int n = 0;
	for (int i = 0; i < m->n_vertices; i++) {
		lo = fminf(lo, m->vertices[i][1]);
		hi = fmaxf(hi, m->vertices[i][1]);
	}
	const float below = lo + 0.25f * (hi - lo);
	for (int i = 0; i < m->n_vertices; i++)
		n += piece[i] == 0 && m->vertices[i][1] < below;
	fprintf(f, "Geometry: 500, \"Geometry::jawOpen\", \"Shape\" {\nVersion: 100\nIndexes: *%d {\na: ", n);
	for (int i = 0, k = 0; i < m->n_vertices; i++)
		if (piece[i] == 0 && m->vertices[i][1] < below)
			fprintf(f, "%s%d", k++ ? "," : "", i);
	for (int which = 0; which < 2; which++) {
		fprintf(f, "\n}\n%s: *%d {\na: ", which ? "Normals" : "Vertices", 3 * n);
		for (int i = 0; i < n; i++)
			fprintf(f, "%s0,%g,0", i ? "," : "", which ? 0 : -0.03 * how->unit * (double)(hi - lo));
	}
	fprintf(f, "\n}\n}\n");
}

static bool skin(const char *path, int px, struct err *err)
{
	uint8_t *rgb = mem_new(3 * (size_t)px * (size_t)px, 1);
	for (int i = 0; i < px * px; i++)
		memcpy(rgb + 3 * i, i / 8 % 2 ? "\xd8\xa8\x90" : "\xd0\xa0\x88", 3);
	const bool ok = picture_png_write(path, rgb, px, px, 3, err);
	free(rgb);
	return ok;
}

bool fbx_write(const char *path, const struct mesh *mesh, const struct dressed *how, struct err *err)
{
	const char *slash = strrchr(path, '/');
	char *png = mem_printf("%.*s/skin.png", slash ? (int)(slash - path) : 1, slash ? path : ".");
	FILE *f = fopen(path, "w");
	struct topology t;
	topology_make(&t, mesh);
	bool ok = f || err_set(err, "%s: cannot be written", path);
	if (ok) {
		fputs("; FBX 7.4.0 project file\nFBXHeaderExtension:  {\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}\nGlobalSettings:  {\nVersion: 1000\nProperties70:  {\n"
		      "P: \"UpAxis\", \"int\", \"Integer\", \"\",1\nP: \"UnitScaleFactor\", \"double\", \"Number\", \"\",1\n}\n}\nObjects:  {\n", f);
		geometry(f, mesh, t.piece, true, how);
		geometry(f, mesh, t.piece, false, how);
		shape(f, mesh, t.piece, how);
		fputs("Model: 200, \"Model::Head\", \"Mesh\" {\nVersion: 232\n}\nModel: 201, \"Model::Eyes\", \"Mesh\" {\nVersion: 232\n}\n"
		      "Material: 300, \"Material::Skin\", \"\" {\nVersion: 102\nShadingModel: \"lambert\"\nMultiLayer: 0\nProperties70:  {\n"
		      "P: \"DiffuseColor\", \"Color\", \"\", \"A\",1,1,1\n}\n}\nMaterial: 301, \"Material::Eyeballs\", \"\" {\nVersion: 102\nShadingModel: \"lambert\"\n"
		      "MultiLayer: 0\nProperties70:  {\nP: \"DiffuseColor\", \"Color\", \"\", \"A\",0.1,0.9,0.1\n}\n}\nTexture: 400, \"Texture::t\", \"\" {\nType: \"TextureVideoClip\"\n"
		      "Version: 202\nTextureName: \"Texture::t\"\nFileName: \"C:\\Users\\artist\\skin.png\"\nRelativeFilename: \"..\\textures\\skin.png\"\n}\n"
		      "Deformer: 600, \"Deformer::blend\", \"BlendShape\" {\nVersion: 100\n}\nDeformer: 700, \"SubDeformer::jawOpen\", \"BlendShapeChannel\" {\nVersion: 100\n"
		      "DeformPercent: 0\nFullWeights: *1 {\na: 100\n}\n}\n}\nConnections:  {\nC: \"OO\",200,0\nC: \"OO\",201,0\nC: \"OO\",100,200\nC: \"OO\",101,201\n"
		      "C: \"OO\",300,200\nC: \"OO\",301,201\nC: \"OP\",400,300, \"DiffuseColor\"\nC: \"OO\",600,100\nC: \"OO\",700,600\nC: \"OO\",500,700\n}\n", f);
		ok = !fclose(f) || err_set(err, "%s: cannot be written", path);
	}
	topology_free(&t);
	ok = ok && skin(png, how->texture_px, err);
	free(png);
	return ok;
}
