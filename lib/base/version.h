#ifndef BASE_VERSION_H
#define BASE_VERSION_H
#define EYEWRIGHT_VERSION "0.1"
#endif
