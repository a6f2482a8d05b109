// Light and shadow as the stills have them: OpenGL's own lighting, without a gamma, at every pixel.
"use strict";
(() => {
  // The light that a surface reflects: for the colour of a fragment, and for water at a vertex.
  const SHED = `vec3 shed(vec3 normal, vec3 view, vec3 direction, vec3 diffuse, vec3 specular) {
  float facing = dot(normal, direction);
  if (facing <= 0.0) return vec3(0.0);
  float gloss = shine * pow(max(dot(normal, normalize(direction + view)), 0.0), max(shininess, 1e-3));
  return facing * diffuse * colour + gloss * specular;
}
`;

  const VERTEX = `
#include <common>
#include <shadowmap_pars_vertex>
varying vec3 vNormal;
varying vec3 vView;
varying vec3 vObject;
#ifdef GIVEN_UV
varying vec2 vGiven;
#endif
void main() {
  vObject = position;
#ifdef GIVEN_UV
  vGiven = uv;
#endif
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  vec4 worldPosition = modelMatrix * vec4(position, 1.0);
  vView = -eye.xyz;
  vNormal = normalMatrix * normal;
  gl_Position = projectionMatrix * eye;
  #include <shadowmap_vertex>
}`;

  // The shadow of four texels, weighed by where the point is among them.
  const FRAGMENT = `
uniform vec3 colour;
uniform float opacity;
uniform float emission;
uniform float shine;
uniform float shininess;
uniform vec3 ambient;
uniform vec3 headDiffuse;
uniform vec3 headSpecular;
varying vec3 vNormal;
varying vec3 vView;
varying vec3 vObject;
#include <common>
#include <packing>
#include <bsdfs>
#include <lights_pars_begin>
#include <shadowmap_pars_fragment>
#if NUM_DIR_LIGHTS > 0
uniform vec3 directionalSpecular[NUM_DIR_LIGHTS];
uniform float directionalApart[NUM_DIR_LIGHTS];
#endif
#if NUM_SPOT_LIGHTS > 0
uniform vec3 spotSpecular[NUM_SPOT_LIGHTS];
uniform float spotApart[NUM_SPOT_LIGHTS];
#endif
#ifdef PICTURE
uniform sampler2D picture;
uniform vec2 repeats;
#endif
#ifdef CUBE
uniform samplerCube picture;
uniform vec3 repeats;
#endif
#ifdef GIVEN_UV
varying vec2 vGiven;
#endif
#ifdef USE_SHADOWMAP
float lit(sampler2D map, vec2 size, float bias, vec4 at) {
  vec3 p = at.xyz / at.w;
  if (p.x <= 0.0 || p.x >= 1.0 || p.y <= 0.0 || p.y >= 1.0 || p.z > 1.0) return 1.0;
  return texture2DShadowLerp(map, size, p.xy, p.z + bias);
}
#endif
${SHED}void main() {
  vec3 normal = normalize(vNormal);
#ifdef DOUBLE_SIDED
  if (!gl_FrontFacing) normal = -normal;
#endif
  vec3 view = normalize(vView);
  // A light that casts shadows is a pass of its own, whose sum is cut off at white by itself.
  vec3 seen = colour * (ambient + emission) + shed(normal, view, view, headDiffuse, headSpecular);
  vec3 apart = vec3(0.0);
  vec3 part;
  float open;
#if NUM_DIR_LIGHTS > 0
  DirectionalLight sun;
  #pragma unroll_loop
  for ( int i = 0; i < NUM_DIR_LIGHTS; i ++ ) {
    sun = directionalLights[ i ];
    open = 1.0;
    #if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_DIR_LIGHT_SHADOWS )
    if (dot(normal, sun.direction) > 0.0) open = lit(directionalShadowMap[ i ], sun.shadowMapSize, sun.shadowBias, vDirectionalShadowCoord[ i ]);
    #endif
    part = open * shed(normal, view, sun.direction, sun.color, directionalSpecular[ i ]);
    seen += (1.0 - directionalApart[ i ]) * part;
    apart += directionalApart[ i ] * min(part, 1.0);
  }
#endif
#if NUM_SPOT_LIGHTS > 0
  SpotLight lamp;
  vec3 toLamp;
  float cone;
  #pragma unroll_loop
  for ( int i = 0; i < NUM_SPOT_LIGHTS; i ++ ) {
    lamp = spotLights[ i ];
    toLamp = normalize(lamp.position + vView);
    cone = dot(toLamp, lamp.direction);
    open = cone > lamp.coneCos ? pow(cone, lamp.decay) : 0.0;
    #if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
    open *= lit(spotShadowMap[ i ], lamp.shadowMapSize, lamp.shadowBias, vSpotShadowCoord[ i ]);
    #endif
    part = open * shed(normal, view, toLamp, lamp.color, spotSpecular[ i ]);
    seen += (1.0 - spotApart[ i ]) * part;
    apart += spotApart[ i ] * min(part, 1.0);
  }
#endif
  seen = min(seen, 1.0) + apart;
#ifdef PICTURE
  #ifdef GIVEN_UV
  seen *= texture2D(picture, vGiven).rgb;
  #else
  seen *= texture2D(picture, vec2(0.5, -0.5) * repeats * vObject.xy - 0.5).rgb;
  #endif
#endif
#ifdef CUBE
  seen *= textureCube(picture, repeats * vObject).rgb;
#endif
  gl_FragColor = vec4(seen, opacity);
}`;

  // Water fills the picture and is smooth: it is lit at its vertices, without shadows, from both sides.
  const WATER_VERTEX = `
uniform vec3 colour;
uniform float emission;
uniform float shine;
uniform float shininess;
uniform vec3 ambient;
uniform vec3 headDiffuse;
uniform vec3 headSpecular;
uniform float water;
varying vec4 vSeen;
varying vec2 vGiven;
#include <common>
#include <bsdfs>
#include <lights_pars_begin>
#if NUM_DIR_LIGHTS > 0
uniform vec3 directionalSpecular[NUM_DIR_LIGHTS];
#endif
${SHED}void main() {
  vGiven = uv;
  vec4 eye = modelViewMatrix * vec4(position, 1.0);
  vec3 view = normalize(-eye.xyz);
  vec3 across = normalize(normalMatrix * normal);
  if (dot(across, view) < 0.0) across = -across;
  vec3 seen = colour * (ambient + emission) + shed(across, view, view, headDiffuse, headSpecular);
#if NUM_DIR_LIGHTS > 0
  #pragma unroll_loop
  for ( int i = 0; i < NUM_DIR_LIGHTS; i ++ ) {
    seen += shed(across, view, directionalLights[ i ].direction, directionalLights[ i ].color, directionalSpecular[ i ]);
  }
#endif
  // It hides what is behind it the more, the flatter one looks along it.
  vSeen = vec4(min(seen, 1.0), mix(water, 1.0, pow(1.0 - dot(across, view), 2.0)));
  gl_Position = projectionMatrix * eye;
}`;

  const WATER_FRAGMENT = `
varying vec4 vSeen;
varying vec2 vGiven;
#ifdef PICTURE
uniform sampler2D picture;
#endif
void main() {
  gl_FragColor = vSeen;
#ifdef PICTURE
  gl_FragColor.rgb *= texture2D(picture, vGiven).rgb;
#endif
}`;

  function picture(asset, anisotropy) {
    const made = new THREE.DataTexture(asset.rgb, asset.width, asset.height, THREE.RGBFormat);
    made.wrapS = made.wrapT = THREE.RepeatWrapping;
    made.magFilter = THREE.LinearFilter;
    made.minFilter = THREE.LinearMipMapLinearFilter;
    made.generateMipmaps = true;
    made.anisotropy = anisotropy;
    made.needsUpdate = true;
    return made;
  }

  function cube(asset) {
    const side = asset.width, bytes = 3 * side * side;
    const faces = Array.from({length: 6}, (_, i) => {
      const face = new THREE.DataTexture(asset.rgb.subarray(i * bytes, (i + 1) * bytes), side, side, THREE.RGBFormat);
      face.needsUpdate = true;
      return face;
    });
    const made = new THREE.CubeTexture(faces);
    made.format = THREE.RGBFormat;
    made.magFilter = made.minFilter = THREE.LinearFilter;
    made.generateMipmaps = false;
    made.needsUpdate = true;
    return made;
  }

  // The lights, which all materials of a scene share.
  function lightUniforms() {
    return {ambient: {value: new THREE.Vector3()}, headDiffuse: {value: new THREE.Vector3()},
            headSpecular: {value: new THREE.Vector3()}, directionalSpecular: {value: []}, spotSpecular: {value: []},
            directionalApart: {value: []}, spotApart: {value: []}};
  }

  function material(look, shared, texture) {
    const defines = {};
    const uniforms = THREE.UniformsUtils.merge([THREE.UniformsLib.lights]);
    Object.assign(uniforms, shared, {
      colour: {value: new THREE.Vector3(...look.rgba)}, opacity: {value: look.rgba[3]},
      emission: {value: look.emission}, shine: {value: look.specular}, shininess: {value: 128 * look.shininess},
      water: {value: look.water || 0}});
    if (texture && texture.isCubeTexture) {
      defines.CUBE = "";
      uniforms.picture = {value: texture};
      uniforms.repeats = {value: new THREE.Vector3(...look.repeats)};
    } else if (texture) {
      defines.PICTURE = "";
      if (look.givenUv) defines.GIVEN_UV = "";
      uniforms.picture = {value: texture};
      uniforms.repeats = {value: new THREE.Vector2(...look.repeats)};
    }
    const seeThrough = look.rgba[3] < 0.995 || look.water > 0;
    return new THREE.ShaderMaterial({
      vertexShader: look.water > 0 ? WATER_VERTEX : VERTEX,
      fragmentShader: look.water > 0 ? WATER_FRAGMENT : FRAGMENT, uniforms, defines, lights: true,
      side: look.bothSides ? THREE.DoubleSide : THREE.FrontSide,
      transparent: seeThrough, depthWrite: !seeThrough});
  }

  // The model's sky, around the camera wherever it is.
  function sky(texture) {
    const made = new THREE.Mesh(new THREE.BoxBufferGeometry(2, 2, 2), new THREE.ShaderMaterial({
      vertexShader: `
varying vec3 vDirection;
void main() {
  vDirection = position;
  gl_Position = projectionMatrix * vec4(mat3(viewMatrix) * position, 1.0);
  gl_Position.z = 0.99999 * gl_Position.w;
}`,
      fragmentShader: `
uniform samplerCube picture;
varying vec3 vDirection;
void main() { gl_FragColor = vec4(textureCube(picture, vec3(vDirection.x, vDirection.z, -vDirection.y)).rgb, 1.0); }`,
      uniforms: {picture: {value: texture}}, side: THREE.BackSide, depthWrite: false}));
    made.frustumCulled = false;
    made.renderOrder = -2;
    return made;
  }

  // Where nothing is drawn: from one colour down to another.
  function backdrop() {
    const made = new THREE.Mesh(new THREE.PlaneBufferGeometry(2, 2), new THREE.ShaderMaterial({
      vertexShader: `
varying float vHeight;
void main() { vHeight = 0.5 * position.y + 0.5; gl_Position = vec4(position.xy, 0.99999, 1.0); }`,
      fragmentShader: `
uniform vec3 top;
uniform vec3 bottom;
varying float vHeight;
void main() { gl_FragColor = vec4(mix(bottom, top, vHeight), 1.0); }`,
      uniforms: {top: {value: new THREE.Vector3()}, bottom: {value: new THREE.Vector3()}}, depthWrite: false}));
    made.frustumCulled = false;
    made.renderOrder = -3;
    return made;
  }

  Replay.shading = {picture, cube, lightUniforms, material, sky, backdrop};
})();
