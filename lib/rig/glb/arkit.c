#include "rig/glb/arkit.h"

#include <ctype.h>
#include <string.h>

const char *const arkit_names[ARKIT_SHAPES] = {
	"eyeBlinkLeft", "eyeLookDownLeft", "eyeLookInLeft", "eyeLookOutLeft", "eyeLookUpLeft", "eyeSquintLeft", "eyeWideLeft", "eyeBlinkRight",
	"eyeLookDownRight", "eyeLookInRight", "eyeLookOutRight", "eyeLookUpRight", "eyeSquintRight", "eyeWideRight", "jawForward", "jawLeft",
	"jawRight", "jawOpen", "mouthClose", "mouthFunnel", "mouthPucker", "mouthLeft", "mouthRight", "mouthSmileLeft", "mouthSmileRight",
	"mouthFrownLeft", "mouthFrownRight", "mouthDimpleLeft", "mouthDimpleRight", "mouthStretchLeft", "mouthStretchRight", "mouthRollLower",
	"mouthRollUpper", "mouthShrugLower", "mouthShrugUpper", "mouthPressLeft", "mouthPressRight", "mouthLowerDownLeft", "mouthLowerDownRight",
	"mouthUpperUpLeft", "mouthUpperUpRight", "browDownLeft", "browDownRight", "browInnerUp", "browOuterUpLeft", "browOuterUpRight",
	"cheekPuff", "cheekSquintLeft", "cheekSquintRight", "noseSneerLeft", "noseSneerRight", "tongueOut",
};

const char *const glb_pose_names[GLB_POSES] = { "eyeBlinkLeft", "eyeBlinkRight", "eyeLookUpLeft", "eyeLookUpRight", "eyeLookDownLeft",
	                                            "eyeLookDownRight", "eyeLookInLeft", "eyeLookInRight", "eyeLookOutLeft",
	                                            "eyeLookOutRight", "eyeWideLeft", "eyeWideRight" };

const char *const glb_half_names[GLB_HALVES] = { "eyeBlinkLeft_half", "eyeBlinkRight_half" };

const char *const glb_turned_names[GLB_TURNED] = { "eyeBlinkLeft_down", "eyeBlinkRight_down", "eyeBlinkLeft_up", "eyeBlinkRight_up",
	                                                    "eyeBlinkLeft_down_half", "eyeBlinkRight_down_half", "eyeBlinkLeft_up_half", "eyeBlinkRight_up_half" };

int glb_turned_look(int turned)
{
	enum { LOOK_UP = 2, LOOK_DOWN = 4 };  // glb_pose_names: of the left eye
	return (turned % GLB_TURNED_LOOKS < 2 ? LOOK_DOWN : LOOK_UP) + turned % 2;
}

/* Letters and digits alone, small; what stands before the last dot is left out, a side of one letter written in full. */
static void plain(char out[64], const char *name)
{
	const char *dot = strrchr(name, '.'), *from = dot ? dot + 1 : name;
	const size_t n = strlen(from);
	size_t k = 0;
	const char side = n > 2 && (from[n - 2] == '_' || from[n - 2] == ' ' || islower((unsigned char)from[n - 2])) ? from[n - 1] : 0;
	const bool left = side == 'L' || (side == 'l' && from[n - 2] == '_'), right = side == 'R' || (side == 'r' && from[n - 2] == '_');
	for (size_t i = 0; i < n - (left || right) && k < 57; i++)
		if (isalnum((unsigned char)from[i]))
			out[k++] = (char)tolower((unsigned char)from[i]);
	strcpy(out + k, left ? "left" : right ? "right" : "");
}

bool arkit_means(const char *name, const char *arkit)
{
	char a[64], b[64];
	plain(a, name);
	plain(b, arkit);
	return !strcmp(a, b);
}
