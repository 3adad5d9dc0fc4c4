/* meshes: which characters have the topology of the subject's own mesh.
 */
#ifndef PLAN_MESHES_H
#define PLAN_MESHES_H

/* Counts the meshes in the capture's targets/, and those among them that have exactly the faces of subject.ply or subject.obj: these
 * are not registered, vertex goes to vertex. Files above 64 MB are not looked into and count as different. */
void plan_characters(int *all, int *same, const char *capture);

#endif
