// three.js: the function joins each lamp's own light in a MeshPhysicalMaterial. The geometry has tangents; a trace
// of anisotropy makes the material use them.
//
//   const table = await new EXRLoader().setDataType(THREE.FloatType).loadAsync("disc.exr");
//   table.minFilter = table.magFilter = THREE.NearestFilter;
//   const glsl = await (await fetch("disc.glsl")).text();
//   const material = new THREE.MeshPhysicalMaterial({ metalness: 1, roughness: 0.3, anisotropy: 1e-3 });
//   material.onBeforeCompile = (shader) => {
//     Object.assign(shader.uniforms, {
//       aureole_table: { value: table }, aureole_scale: { value: 1 },
//       aureole_half_range: { value: 2 }, aureole_warp: { value: 5 },
//     });
//     shader.fragmentShader = shader.fragmentShader.replace("#include <lights_physical_pars_fragment>", `
//       #include <lights_physical_pars_fragment>
//       #define AUREOLE_ROW_0_BELOW
//       ${glsl}
//       void aureole_direct(const in IncidentLight lamp, const in vec3 place, const in vec3 normal,
//                           const in vec3 to_eye, const in vec3 coat, const in PhysicalMaterial material,
//                           inout ReflectedLight light) {
//         RE_Direct_Physical(lamp, place, normal, to_eye, coat, material, light);
//         float cosine = max(dot(normal, lamp.direction), 0.0);
//         light.directSpecular += cosine * lamp.color * aureole_diffraction(
//             lamp.direction, to_eye, normalize(vTangent), normalize(vBitangent), vec3(1.0));
//       }
//       #undef RE_Direct
//       #define RE_Direct aureole_direct`);
//   };
//
// Godot 4: paste the functions into a spatial shader, give the uniforms `uniform sampler2D aureole_table :
// filter_nearest, repeat_disable;`, and add in `void light()`:
//   SPECULAR_LIGHT += ATTENUATION * LIGHT_COLOR * max(dot(NORMAL, LIGHT), 0.0)
//                     * aureole_diffraction(LIGHT, VIEW, TANGENT, BINORMAL, vec3(1.0));
// with `varying` copies of TANGENT and BINORMAL from `fragment()`, which `light()` does not see.
//
// Unreal: a Custom node takes the same lines as HLSL: vec2 is float2, mix is lerp, texelFetch(t, p, 0) is
// t.Load(int3(p, 0)); a node's own functions stand within a struct. Lamps that a material does not see are given
// to it as a parameter collection.
