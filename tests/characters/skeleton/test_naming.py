"""Joints are recognised however a program, a laboratory or an artist names them."""

from dataclasses import replace

import pytest

from cubeling.characters.skeleton.anatomy import Anatomy
from tests.characters.skeleton.bodies import DOG, PERSON, named_body
from tests.examples import some

# Words for left and right, then the names in the order of PERSON, then helper joints.
PEOPLE = {
    "Mixamo": "Left Right mixamorig:Hips mixamorig:Spine mixamorig:Spine1 mixamorig:Neck "
    "mixamorig:Head mixamorig:{}Shoulder mixamorig:{}Arm mixamorig:{}ForeArm mixamorig:{}Hand "
    "mixamorig:{}UpLeg mixamorig:{}Leg mixamorig:{}Foot mixamorig:{}ToeBase "
    "mixamorig:{}Toe_End<mixamorig:{}ToeBase mixamorig:HeadTop_End<mixamorig:Head",
    "Mixamo in three.js": "Left Right mixamorig9Hips mixamorig9Spine mixamorig9Spine1 "
    "mixamorig9Neck mixamorig9Head mixamorig9{}Shoulder mixamorig9{}Arm mixamorig9{}ForeArm "
    "mixamorig9{}Hand mixamorig9{}UpLeg mixamorig9{}Leg mixamorig9{}Foot mixamorig9{}ToeBase",
    "Mixamo from Sketchfab": "Left Right mixamorig:Hips_01 mixamorig:Spine_02 mixamorig:Spine1_03 "
    "mixamorig:Neck_05 mixamorig:Head_06 mixamorig:{}Shoulder_08 mixamorig:{}Arm_09 "
    "mixamorig:{}ForeArm_010 mixamorig:{}Hand_011 mixamorig:{}UpLeg_055 mixamorig:{}Leg_056 "
    "mixamorig:{}Foot_057 mixamorig:{}ToeBase_058 _rootJoint>mixamorig:Hips_01",
    "Unity, VRM": "Left Right Hips Spine Chest Neck Head {}Shoulder {}UpperArm {}LowerArm {}Hand "
    "{}UpperLeg {}LowerLeg {}Foot {}Toes",
    "Unity-chan": "Left Right Character1_Hips Character1_Spine Character1_Spine1 Character1_Neck "
    "Character1_Head Character1_{}Shoulder Character1_{}Arm Character1_{}ForeArm "
    "Character1_{}Hand Character1_{}UpLeg Character1_{}Leg Character1_{}Foot Character1_{}ToeBase "
    "J_{}_HairFront<Character1_Head J_{}_Skirt_00<Character1_Hips",
    "VRoid": "L R J_Bip_C_Hips J_Bip_C_Spine J_Bip_C_Chest J_Bip_C_Neck J_Bip_C_Head "
    "J_Bip_{}_Shoulder J_Bip_{}_UpperArm J_Bip_{}_LowerArm J_Bip_{}_Hand J_Bip_{}_UpperLeg "
    "J_Bip_{}_LowerLeg J_Bip_{}_Foot J_Bip_{}_ToeBase J_Sec_{}_Bust1<J_Bip_C_Chest "
    "J_Sec_{}_CoatSkirt_01<J_Bip_{}_UpperLeg",
    "MMD": "左 右 センター 上半身 上半身2 首 頭 {}肩 {}腕 {}ひじ {}手首 {}足 {}ひざ {}足首 "
    "{}つま先 全ての親>センター {}肩P>{}肩 {}肩C>{}腕 {}腕捩>{}ひじ {}手捩>{}手首 "
    "{}足ＩＫ<全ての親@Foot "
    "{}つま先ＩＫ<{}足ＩＫ@Toes 下半身>左足 腰キャンセル{}>{}足",
    "MMD with joints twice": "左 右 センター 上半身 上半身2 首 頭 {}肩 {}腕 {}ひじ {}手首 {}足 "
    "{}ひざ {}足首 {}つま先 下半身>左足 {}足D<下半身@UpperLeg {}ひざD<{}足D@LowerLeg "
    "{}足首D<{}ひざD@Foot {}足先EX<{}足首D@Toes",
    "MMD, translated": "L R Center UpperBody UpperBody2 Neck Head Shoulder_{} Arm_{} Elbow_{} "
    "Wrist_{} Leg_{} Knee_{} Ankle_{} ToeTip_{} ParentNode>Center LegIK_{}<ParentNode@Foot",
    "Rigify": "L R spine spine.001 spine.002 spine.004 spine.006 shoulder.{} upper_arm.{} "
    "forearm.{} hand.{} thigh.{} shin.{} foot.{} toe.{} pelvis.{}<spine heel.02.{}<foot.{}",
    "Rigify, deforming": "L R DEF-spine DEF-spine.001 DEF-spine.002 DEF-spine.004 DEF-spine.006 "
    "DEF-shoulder.{} DEF-upper_arm.{} DEF-forearm.{} DEF-hand.{} DEF-thigh.{} DEF-shin.{} "
    "DEF-foot.{} DEF-toe.{} DEF-thigh.{}.001>DEF-shin.{} DEF-shin.{}.001>DEF-foot.{} "
    "DEF-upper_arm.{}.001>DEF-forearm.{} DEF-forearm.{}.001>DEF-hand.{} "
    "DEF-pelvis.{}<DEF-spine DEF-breast.{}<DEF-spine.002",
    "Rigify, original": "L R ORG-spine ORG-spine.001 ORG-spine.002 ORG-spine.004 ORG-spine.006 "
    "ORG-shoulder.{} ORG-upper_arm.{} ORG-forearm.{} ORG-hand.{} ORG-thigh.{} ORG-shin.{} "
    "ORG-foot.{} ORG-toe.{} MCH-thigh_ik.{}<ORG-spine thigh_ik_target.{}<ORG-spine",
    "Rigify, all joints": "L R DEF-spine DEF-spine.001 DEF-spine.002 DEF-spine.004 DEF-spine.006 "
    "DEF-shoulder.{} DEF-upper_arm.{} DEF-forearm.{} DEF-hand.{} DEF-thigh.{} DEF-shin.{} "
    "DEF-foot.{} DEF-toe.{} root>DEF-spine ORG-thigh.{}<root@UpperLeg "
    "ORG-shin.{}<ORG-thigh.{}@LowerLeg ORG-foot.{}<ORG-shin.{}@Foot ORG-toe.{}<ORG-foot.{}@Toes "
    "thigh_fk.{}<root@UpperLeg "
    "shin_fk.{}<thigh_fk.{}@LowerLeg foot_fk.{}<shin_fk.{}@Foot MCH-foot.{}<root@Foot "
    "ORG-upper_arm.{}<root@UpperArm ORG-forearm.{}<ORG-upper_arm.{}@LowerArm "
    "ORG-hand.{}<ORG-forearm.{}@Hand",
    "Rigify, old": "L R hips spine ribs neck head shoulder.{} upper_arm.{} forearm.{} hand.{} "
    "thigh.{} shin.{} foot.{} toe.{}",
    "Auto-Rig Pro": "l r root.x spine_01.x spine_02.x neck.x head.x shoulder.{} arm_stretch.{} "
    "forearm_stretch.{} hand.{} thigh_stretch.{} leg_stretch.{} foot.{} toes_01.{} "
    "thigh_twist.{}<root.x leg_twist.{}<leg_stretch.{} arm_twist.{}<shoulder.{}",
    "MHX": "L R Hips Spine1 Spine3 Neck Head Clavicle_{} UpArm_{} LoArm_{} Hand_{} UpLeg_{} "
    "LoLeg_{} Foot_{} Toe_{} Hip_{}>UpLeg_{}",
    "MakeHuman": "L R root spine02 spine01 neck01 head clavicle.{} upperarm01.{} lowerarm01.{} "
    "wrist.{} upperleg01.{} lowerleg01.{} foot.{} toe1-1.{} upperleg02.{}>lowerleg01.{} "
    "lowerleg02.{}>foot.{} upperarm02.{}>lowerarm01.{} lowerarm02.{}>wrist.{} "
    "pelvis.{}>upperleg01.{} shoulder01.{}>upperarm01.{}",
    "Biped": "L R Bip01_Pelvis Bip01_Spine Bip01_Spine1 Bip01_Neck Bip01_Head Bip01_{}_Clavicle "
    "Bip01_{}_UpperArm Bip01_{}_Forearm Bip01_{}_Hand Bip01_{}_Thigh Bip01_{}_Calf Bip01_{}_Foot "
    "Bip01_{}_Toe0 Bip01>Bip01_Pelvis Bip01_{}_Toe0Nub<Bip01_{}_Toe0 Bip01_Footsteps<Bip01",
    "Biped 2010": "L R Bip001_Pelvis Bip001_Spine Bip001_Spine1 Bip001_Neck Bip001_Head "
    "Bip001_{}_Clavicle Bip001_{}_UpperArm Bip001_{}_Forearm Bip001_{}_Hand Bip001_{}_Thigh "
    "Bip001_{}_Calf Bip001_{}_Foot Bip001_{}_Toe0",
    "CAT": "L R CATRigHub001 CATRigSpine1 CATRigSpine2 CATRigNeck CATRigHead "
    "CATRig{}ArmCollarbone CATRig{}Arm1 CATRig{}Arm2 CATRig{}ArmPalm CATRig{}Leg1 CATRig{}Leg2 "
    "CATRig{}LegAnkle CATRig{}LegDigit11 CATRig{}LegPlatform<@Foot",
    "Source": "L R ValveBiped.Bip01_Pelvis ValveBiped.Bip01_Spine ValveBiped.Bip01_Spine1 "
    "ValveBiped.Bip01_Neck1 ValveBiped.Bip01_Head1 ValveBiped.Bip01_{}_Clavicle "
    "ValveBiped.Bip01_{}_UpperArm ValveBiped.Bip01_{}_Forearm ValveBiped.Bip01_{}_Hand "
    "ValveBiped.Bip01_{}_Thigh ValveBiped.Bip01_{}_Calf ValveBiped.Bip01_{}_Foot "
    "ValveBiped.Bip01_{}_Toe0 ValveBiped.Bip01_{}_Trapezius<ValveBiped.Bip01_{}_Clavicle",
    "Unreal": "l r pelvis spine_01 spine_02 neck_01 head clavicle_{} upperarm_{} lowerarm_{} "
    "hand_{} thigh_{} calf_{} foot_{} ball_{} root>pelvis thigh_twist_01_{}<thigh_{} "
    "calf_twist_01_{}<calf_{} upperarm_twist_01_{}<upperarm_{} ik_foot_root<root "
    "ik_foot_{}<ik_foot_root@Foot ik_hand_root<root ik_hand_gun<ik_hand_root "
    "ik_hand_{}<ik_hand_gun@Hand",
    "MetaHuman": "l r pelvis spine_01 spine_02 neck_01 head clavicle_{} upperarm_{} lowerarm_{} "
    "hand_{} thigh_{} calf_{} foot_{} ball_{} thigh_correctiveRoot_{}<thigh_{} "
    "calf_knee_{}<calf_{} calf_kneeBack_{}<calf_{} ankle_bck_{}<foot_{} wrist_inner_{}<hand_{}",
    "Daz": "l r hip abdomenLower chestLower neckLower head {}Collar {}ShldrBend {}ForearmBend "
    "{}Hand {}ThighBend {}Shin {}Foot {}Toe {}ThighTwist>{}Shin {}ShldrTwist>{}ForearmBend "
    "{}ForearmTwist>{}Hand pelvis>lThighBend {}BigToe<{}Toe",
    "Daz 9": "l r hip spine1 spine3 neck1 head {}_shoulder {}_upperarm {}_forearm {}_hand {}_thigh "
    "{}_shin {}_foot {}_toes {}_thightwist1<{}_thigh {}_shintwist1<{}_shin "
    "{}_upperarmtwist1<{}_upperarm",
    "Poser": "l r hip abdomen chest neck head {}Collar {}Shldr {}ForeArm {}Hand {}Thigh {}Shin "
    "{}Foot {}Toe {}Buttock>{}Thigh",
    "Reallusion": "L R CC_Base_Hip CC_Base_Spine01 CC_Base_Spine02 CC_Base_NeckTwist01 "
    "CC_Base_Head CC_Base_{}_Clavicle CC_Base_{}_Upperarm CC_Base_{}_Forearm CC_Base_{}_Hand "
    "CC_Base_{}_Thigh CC_Base_{}_Calf CC_Base_{}_Foot CC_Base_{}_ToeBase "
    "CC_Base_Pelvis>CC_Base_L_Thigh CC_Base_{}_ThighTwist01<CC_Base_{}_Thigh "
    "CC_Base_{}_KneeShareBone<CC_Base_{}_Calf CC_Base_{}_CalfTwist01<CC_Base_{}_Calf "
    "RL_BoneRoot>CC_Base_Hip",
    "Maya HumanIK": "Left Right Character_Hips Character_Spine Character_Spine1 Character_Neck "
    "Character_Head Character_{}Shoulder Character_{}Arm Character_{}ForeArm Character_{}Hand "
    "Character_{}UpLeg Character_{}Leg Character_{}Foot Character_{}ToeBase "
    "Character_Reference>Character_Hips Character_{}UpLegRoll<Character_{}UpLeg",
    "Advanced Skeleton": "L R Root_M Spine1_M Chest_M Neck_M Head_M Scapula_{} Shoulder_{} "
    "Elbow_{} Wrist_{} Hip_{} Knee_{} Ankle_{} Toes_{} HipPart1_{}>Knee_{} KneePart1_{}>Ankle_{} "
    "ShoulderPart1_{}>Elbow_{} ElbowPart1_{}>Wrist_{} ToesEnd_{}<Toes_{}",
    "mGear": "L R spine_C0_pelvis_jnt spine_C0_01_jnt spine_C0_02_jnt neck_C0_0_jnt "
    "neck_C0_head_jnt shoulder_{}0_shoulder_jnt arm_{}0_0_jnt arm_{}0_1_jnt arm_{}0_end_jnt "
    "leg_{}0_0_jnt leg_{}0_1_jnt foot_{}0_0_jnt - leg_{}0_end_jnt>foot_{}0_0_jnt",
    "artist: bind joints": "L R C_hips0001_bind_JNT C_spine0001_bind_JNT C_chest0001_bind_JNT "
    "C_neck0001_bind_JNT C_head0001_bind_JNT {}_clavicle0001_bind_JNT {}_armUpper0001_bind_JNT "
    "{}_armLower0001_bind_JNT {}_hand0001_bind_JNT {}_legUpper0001_bind_JNT "
    "{}_legLower0001_bind_JNT {}_foot0001_bind_JNT {}_toe0001_bind_JNT",
    "artist: joints of Maya": "lf rt root_jnt spine_1_jnt spine_2_jnt neck_jnt head_jnt "
    "{}_clav_jnt {}_shoulder_jnt {}_elbow_jnt {}_wrist_jnt {}_hip_jnt {}_knee_jnt {}_ankle_jnt "
    "{}_ball_jnt {}_toe_end_jnt<{}_ball_jnt",
    "artist: the character's name first": "L R knight_arm_pelvis knight_arm_spine1 "
    "knight_arm_spine2 knight_arm_neck knight_arm_head knight_arm_clavicle_{} "
    "knight_arm_upperArm_{} knight_arm_foreArm_{} knight_arm_hand_{} knight_arm_thigh_{} "
    "knight_arm_shin_{} knight_arm_foot_{} knight_arm_toe_{}",
    "artist: suffixed sides": "Lf Rt Pelvis_Jnt Waist_Jnt Torso_Jnt Neck_Jnt Head_Jnt "
    "Clavicle_{}_Jnt UpArm_{}_Jnt LowArm_{}_Jnt Hand_{}_Jnt LegUp_{}_Jnt LegLow_{}_Jnt "
    "Foot_{}_Jnt Toe_{}_Jnt",
    "artist: game weapons and pads": "L R Hips_jnt Spine_jnt Chest_jnt Neck_jnt Head_jnt "
    "Clavicle_{}_jnt UpperArm_{}_jnt LowerArm_{}_jnt Hand_{}_jnt UpperLeg_{}_jnt LowerLeg_{}_jnt "
    "Foot_{}_jnt Toes_{}_jnt KneePad_{}<LowerLeg_{}_jnt ShoulderPad_{}<UpperArm_{}_jnt "
    "Hand_{}_Weapon<Hand_{}_jnt Head_Hat<Head_jnt Hip_Pouch_{}<Hips_jnt",
    "Ready Player Me": "Left Right Hips Spine Spine1 Neck Head {}Shoulder {}Arm {}ForeArm {}Hand "
    "{}UpLeg {}Leg {}Foot {}ToeBase {}Toe_End<{}ToeBase {}Eye<Head HeadTop_End<Head",
    "Quaternius": "L R Hips Abdomen Torso Neck Head Shoulder.{} UpperArm.{} LowerArm.{} Palm.{} "
    "UpperLeg.{} LowerLeg.{} Foot.{} - PoleTarget.{}<@LowerLeg",
    "Quaternius 2023": "L R DEF-hips DEF-spine.001 DEF-spine.002 DEF-neck DEF-head DEF-shoulder.{} "
    "DEF-upper_arm.{} DEF-forearm.{} DEF-hand.{} DEF-thigh.{} DEF-shin.{} DEF-foot.{} DEF-toe.{} "
    "root>DEF-hips",
    "KayKit": "l r hips spine chest - head - upperarm.{} lowerarm.{} wrist.{} upperleg.{} "
    "lowerleg.{} foot.{} toes.{} root>hips hand.{}<wrist.{} handslot.{}<hand.{} "
    "kneeIK.{}<root@LowerLeg control-foot-roll.{}<root@Foot",
    "Synty": "L R Hips Spine_01 Spine_02 Neck Head Clavicle_{} Shoulder_{} Elbow_{} Hand_{} "
    "UpperLeg_{} LowerLeg_{} Ankle_{} Ball_{} Toes_{}<Ball_{} Root>Hips",
    "Roblox": "Left Right LowerTorso UpperTorso - - Head - {}UpperArm {}LowerArm {}Hand "
    "{}UpperLeg {}LowerLeg {}Foot - HumanoidRootPart>LowerTorso",
    "Second Life": "Left Right mPelvis mTorso mChest mNeck mHead mCollar{} mShoulder{} mElbow{} "
    "mWrist{} mHip{} mKnee{} mAnkle{} mToe{} mFoot{}>mToe{} mSkull<mHead",
    "Meshy": "Left Right Hips Spine02 Spine01 neck Head {}Shoulder {}Arm {}ForeArm {}Hand {}UpLeg "
    "{}Leg {}Foot {}ToeBase head_end<Head headfront<Head",
    "Tripo": "L R Hip Spine01 Spine02 NeckTwist01 Head {}_Clavicle {}_Upperarm {}_Forearm {}_Hand "
    "{}_Thigh {}_Calf {}_Foot {}_ToeBase Pelvis>L_Thigh Root>Hip",
    "SMPL": "L R Pelvis Spine1 Spine3 Neck Head {}_Collar {}_Shoulder {}_Elbow {}_Wrist {}_Hip "
    "{}_Knee {}_Ankle {}_Foot {}_Hand<{}_Wrist",
    "SMPL-X": "left right pelvis spine1 spine3 neck head {}_collar {}_shoulder {}_elbow {}_wrist "
    "{}_hip {}_knee {}_ankle {}_foot jaw<head {}_eye_smplhf<head",
    "CMU": "l r root lowerback thorax lowerneck head {}clavicle {}humerus {}radius {}hand {}femur "
    "{}tibia {}foot {}toes {}hipjoint>{}femur {}wrist>{}hand",
    "cgspeed": "Left Right Hips LowerBack Chest Neck Head {}Collar {}Shoulder {}Elbow {}Wrist "
    "{}Hip {}Knee {}Ankle {}Toe",
    "Daz-friendly BVH": "l r hip abdomen chest neck head {}collar {}shoulder {}elbow {}hand "
    "{}thigh {}shin {}foot - {}buttock>{}thigh {}efteye<head",
    "Biovision": "Left Right Hips Chest Chest2 Neck Head {}Collar {}UpArm {}LowArm {}Hand {}UpLeg "
    "{}LowLeg {}Foot -",
    "100STYLE": "Left Right Hips Chest Chest2 Neck Head {}Collar {}Shoulder {}Elbow {}Wrist {}Hip "
    "{}Knee {}Ankle {}Toe",
    "LAFAN1": "Left Right Hips Spine Spine1 Neck Head {}Shoulder {}Arm {}ForeArm {}Hand {}UpLeg "
    "{}Leg {}Foot {}Toe",
    "Bandai-Namco": "L R Hips Spine Chest Neck Head Shoulder_{} UpperArm_{} LowerArm_{} Hand_{} "
    "UpperLeg_{} LowerLeg_{} Foot_{} Toes_{} joint_Root>Hips",
    "Xsens": "Left Right Pelvis L5 T8 Neck Head {}Shoulder {}UpperArm {}ForeArm {}Hand "
    "{}UpperLeg {}LowerLeg {}Foot {}Toe",
    "OptiTrack": "L R Hip Ab Chest Neck Head {}Shoulder {}UArm {}FArm {}Hand {}Thigh {}Shin "
    "{}Foot {}Toe",
    "Rokoko": "Left Right Hips Spine1 Spine2 Neck Head {}Shoulder {}Arm {}ForeArm {}Hand {}Thigh "
    "{}Shin {}Foot {}Toe",
    "Perception Neuron": "Left Right Robot_Hips Robot_Spine Robot_Spine1 Robot_Neck Robot_Head "
    "Robot_{}Shoulder Robot_{}Arm Robot_{}ForeArm Robot_{}Hand Robot_{}UpLeg Robot_{}Leg "
    "Robot_{}Foot -",
    "Kinect": "Left Right SpineBase SpineMid SpineShoulder Neck Head - Shoulder{} Elbow{} Wrist{} "
    "Hip{} Knee{} Ankle{} Foot{} Hand{}<Wrist{} HandTip{}<Hand{}",
    "H-Anim": "l r HumanoidRoot vl5 vt6 vc7 skullbase {}_sternoclavicular {}_shoulder {}_elbow "
    "{}_wrist {}_hip {}_knee {}_ankle {}_metatarsal sacroiliac>l_hip",
    "H-Anim, plain": "l r humanoid_root vl5 vt6 vc4 skull - {}_shoulder {}_elbow {}_wrist {}_hip "
    "{}_knee {}_ankle -",
    "Khronos": "L R torso_joint_1 torso_joint_2 torso_joint_3 neck_joint_1 neck_joint_2 - "
    "arm_joint_{}_1 arm_joint_{}_2 arm_joint_{}_3 leg_joint_{}_1 leg_joint_{}_2 leg_joint_{}_3 "
    "leg_joint_{}_5",
    "Kenney": "left right root torso chest neck head - arm-{}-upper arm-{}-lower hand-{} "
    "leg-{}-upper leg-{}-lower foot-{} -",
    "artist: an apron and greaves": "L R Hips Spine Chest Neck Head Clavicle_{} UpperArm_{} "
    "LowerArm_{} Hand_{} Thigh_{} Shin_{} Foot_{} Toes_{} Front_Leg_Armor_{}<Thigh_{} "
    "Back_Leg_Cape_{}<Hips Front_Apron<Hips",
    "lower case without breaks": "left right hips spine chest neck head {}shoulder {}upperarm "
    "{}forearm {}hand {}upperleg {}lowerleg {}foot {}toes",
    "sides at the end": "Left Right Hips Spine Chest Neck Head Shoulder{} UpperArm{} LowerArm{} "
    "Hand{} UpperLeg{} LowerLeg{} Foot{} Toes{}",
    "words of anatomy": "left right pelvis lumbar thorax cervical skull {}_clavicle {}_humerus "
    "{}_ulna {}_carpus {}_femur {}_tibia {}_tarsus {}_phalanges {}_patella<{}_tibia "
    "{}_fibula<{}_femur",
    "German": "L R Becken Wirbel Brust Hals Kopf Schulter.{} Oberarm.{} Unterarm.{} Hand.{} "
    "Oberschenkel.{} Unterschenkel.{} Fuss.{} Zehen.{}",
    "French": "G D Bassin Colonne Poitrine Cou Tete Epaule_{} Bras_{} AvantBras_{} Main_{} "
    "Cuisse_{} Tibia_{} Pied_{} Orteils_{}",
    "only the feet and hands are named": "L R Hips Bone Bone.001 Neck Head - Bone.{}.001 "
    "Bone.{}.002 Hand.{} Bone.{}.003 Bone.{}.004 Foot.{} -",
    "only the top of each limb is named": "L R Hips Bone Bone.001 Neck Head - Arm.{} "
    "Bone.{}.001 Bone.{}.002 Leg.{} Bone.{}.003 Bone.{}.004 -",
    "no names at all": "1 2 n0 n3 n4 n5 n6 a{}0 a{}1 a{}2 a{}3 b{}0 b{}1 b{}2 b{}3",
}


@pytest.mark.parametrize("style", PEOPLE)
def test_every_naming_convention_of_people_is_recognised(style):
    skeleton, truth = named_body(PEOPLE[style], PERSON)
    anatomy = Anatomy.guess(skeleton)
    found = {part: skeleton.names[joint] for part, joint in anatomy.joints.items()}
    assert {part: name for part, name in found.items() if part[-3:] not in ("Eye", "jaw")} == truth
    assert anatomy.kind == "humanoid"
    assert anatomy.missing == ()


FRAMES = (
    "Left4Dead_{}",
    "cat_head_{}",
    "{}_jnt_end_0",
    "jnt{}",
    "Armature|MyHero {}.001",
    "{}_DEF",
)


@pytest.mark.parametrize("frame", some(FRAMES))
def test_what_all_names_share_does_not_matter(frame):
    for style in PEOPLE:
        skeleton, truth = named_body(PEOPLE[style], PERSON)
        framed = replace(skeleton, names=tuple(frame.format(name) for name in skeleton.names))
        found = Anatomy.guess(framed).joints
        assert {part: skeleton.names[found[part]] for part in truth} == truth, style


# As above, in the order of DOG.
ANIMALS = {
    "hind and front": "L R Hips Spine Neck Head Tail1 Tail2 BackUpLeg.{} BackLowLeg.{} BackFoot.{} "
    "BackToe.{} FrontShoulder.{} FrontUpLeg.{} FrontLowLeg.{} FrontFoot.{} FrontToe.{}",
    "Fox": "Left Right b_Hip_01 b_Spine01_02 b_Neck_04 b_Head_05 b_Tail01_012 b_Tail02_013 "
    "b_{}Leg01_015 b_{}Leg02_016 b_{}Foot01_017 b_{}Foot02_018 - b_{}UpperArm_09 b_{}ForeArm_010 "
    "b_{}Hand_011 -",
    "Biped on all fours": "L R Bip01_Pelvis Bip01_Spine Bip01_Neck Bip01_Head Bip01_Tail "
    "Bip01_Tail1 Bip01_{}_Thigh Bip01_{}_Calf Bip01_{}_HorseLink Bip01_{}_Foot Bip01_{}_Clavicle "
    "Bip01_{}_UpperArm Bip01_{}_Forearm Bip01_{}_Hand -",
    "Rigify wolf": "L R spine.004 spine.005 spine.008 spine.010 - - thigh.{} "
    "shin.{} foot.{} toe.{} shoulder.{} front_thigh.{} front_shin.{} front_foot.{} front_toe.{}",
    "SMAL": "L R pelvis spine Neck Head Tail1 Tail2 {}LegBack1 {}LegBack2 {}LegBack3 {}FootBack - "
    "{}Leg1 {}Leg2 {}Leg3 {}Foot",
    "hSMAL": "L R Pelvis Spine Neck Head Tail1 Tail2 {}BLeg1 {}BLeg2 {}BLeg3 {}BToe {}FLeg1 "
    "{}FLeg2 {}FLeg3 {}FLeg4 {}FToe",
    "corners": "L R root spine neck head tail_1 tail_2 B{}_leg_1 B{}_leg_2 B{}_foot B{}_toe - "
    "F{}_leg_1 F{}_leg_2 F{}_foot F{}_toe",
    "corners after the part": "l r root spine neck head tail_1 tail_2 leg_b{}_1 leg_b{}_2 "
    "leg_b{}_3 leg_b{}_4 - leg_f{}_1 leg_f{}_2 leg_f{}_3 leg_f{}_4",
    "fore and hind": "L R Pelvis Spine Neck Head Tail_01 Tail_02 Hind_Thigh_{} Hind_Calf_{} "
    "Hind_Foot_{} Hind_Ball_{} Scapula_{} Fore_UpperArm_{} Fore_LowerArm_{} Fore_Hand_{} "
    "Fore_Ball_{}",
    "joined words": "Left Right Hips Spine Neck Head Tail1 Tail2 {}hindthigh {}hindshin {}hindfoot "
    "{}hindtoe - {}frontthigh {}frontshin {}frontfoot {}fronttoe",
    "numbered legs": "L R Hips Spine Neck Head Tail1 Tail2 Back_Leg_{}_01 Back_Leg_{}_02 "
    "Back_Leg_{}_03 Back_Leg_{}_04 - Front_Leg_{}_01 Front_Leg_{}_02 Front_Leg_{}_03 "
    "Front_Leg_{}_04",
    "legs that only their place tells apart": "L R Hips Spine Neck Head Tail1 Tail2 Leg1.{} "
    "Leg2.{} Leg3.{} Leg4.{} - Leg5.{} Leg6.{} Leg7.{} Leg8.{}",
    "words of anatomy": "L R pelvis lumbar cervical skull caudal_1 caudal_2 femur_{} tibia_{} "
    "metatarsus_{} hindhoof_{} scapula_{} humerus_{} radius_{} metacarpus_{} forehoof_{}",
    "words of riders": "L R hips spine neck head tail1 tail2 {}_stifle {}_gaskin {}_hock "
    "{}_hindFetlock - {}_frontShoulder {}_frontElbow {}_frontKnee {}_frontFetlock",
    "no names at all": "1 2 n0 n3 n4 n5 - - b{}0 b{}1 b{}2 b{}3 - a{}1 a{}2 a{}3 a{}4",
}


@pytest.mark.parametrize("style", ANIMALS)
def test_every_naming_convention_of_animals_is_recognised(style):
    skeleton, truth = named_body(ANIMALS[style], DOG)
    anatomy = Anatomy.guess(skeleton)
    found = {part: skeleton.names[joint] for part, joint in anatomy.joints.items()}
    assert found == truth
    assert anatomy.kind == "quadruped"
    assert anatomy.missing == ()
