#include "tests/lib/gltf.h"

#include <stdio.h>
#include <stdlib.h>

bool gltf_validator_there(void)
{
	if (system("command -v node > /dev/null 2>&1"))
		return false;
	if (!system("cd build/npm 2> /dev/null && node -e \"require('gltf-validator')\" > /dev/null 2>&1"))
		return true;
	return !system("mkdir -p build/npm && cd build/npm && timeout 30 npm install --no-audit --no-fund --silent gltf-validator > /dev/null 2>&1"
	               " && node -e \"require('gltf-validator')\" > /dev/null 2>&1");
}

bool gltf_is_valid(const char *path)
{
	char command[2048];
	snprintf(command, sizeof command,
	         "cd build/npm && node -e \"require('gltf-validator').validateBytes(new Uint8Array(require('fs').readFileSync('%s')))"
	         ".then(r => { const i = r.issues; if (i.messages.length) console.error(JSON.stringify(i.messages.slice(0, 5))); "
	         "process.exit(i.numErrors + i.numWarnings ? 1 : 0) })\"",
	         path);
	return !system(command);
}
