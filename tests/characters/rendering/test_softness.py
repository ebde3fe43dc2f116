"""Characters are as soft, noisy and hazy as the picture that they stand in."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from cubeling.tracking.appearance import PictureQuality


def test_a_character_gets_the_blur_of_the_picture(stage, view, pawn):
    def width_of_edges(picture):
        """Width of the pawn's outline: how far it goes from the table to the pawn [px]."""
        red = picture[60:75, :, 2].astype(float) - picture[60:75, :, 1]
        slope = np.abs(np.diff(red, axis=1)).max(1)
        return float(np.median(np.ptp(red, axis=1) / slope))

    sharp = width_of_edges(stage.draw(view, [pawn.posed()]))
    same = width_of_edges(
        stage.draw(replace(view, softness=PictureQuality(0.3, 0.0)), [pawn.posed()])
    )
    soft = width_of_edges(
        stage.draw(replace(view, softness=PictureQuality(1.2, 0.0)), [pawn.posed()])
    )
    assert same == pytest.approx(sharp, rel=0.02)
    assert soft > 1.5 * sharp


def test_a_character_gets_the_noise_of_the_picture(stage, view, pawn):
    clean = stage.draw(view, [pawn.posed()]).astype(int)
    first, second = (
        stage.draw(replace(view, softness=PictureQuality(0.3, 5.0)), [pawn.posed()]).astype(int)
        for _ in range(2)
    )
    red = clean[..., 2] - clean[..., 1] > 60
    red &= cv2.erode(red.astype(np.uint8), np.ones((5, 5))) > 0
    assert (first - clean)[red].std() == pytest.approx(5.0, rel=0.1)
    assert abs((first - clean)[red].mean()) < 0.5
    correlation = np.corrcoef((first - clean)[red].ravel(), (second - clean)[red].ravel())[0, 1]
    assert abs(correlation) < 0.1  # it does not stand still
    beside = np.s_[:40]
    assert np.array_equal(first[beside], view.image[beside])


def test_a_character_is_in_the_haze_of_the_picture(stage, view, pawn):
    clear = stage.draw(view, [pawn.posed()]).astype(int)
    hazy = stage.draw(replace(view, softness=PictureQuality(0.3, 0.0, 0.2, 0.8)), [pawn.posed()])
    drawn = (clear != view.image).any(-1) & (clear[..., 2] > clear[..., 1] + 60)
    green = hazy[..., 1][drawn].astype(int)
    assert (clear[..., 1][drawn] < 80).any()
    assert green.min() >= 100  # of 0.2 · 0.8 of all light
    assert (hazy[..., 2][drawn] >= 100).all()
    edges = cv2.dilate(drawn.astype(np.uint8), np.ones((3, 3))) > 0
    brighter = hazy.astype(int)[edges & ~drawn] - clear[edges & ~drawn]
    assert brighter.max() <= 110
    beside = np.s_[:40]
    assert np.array_equal(hazy[beside], view.image[beside])


def test_a_shadow_leaves_the_haze_over_the_table(stage, view, pawn):
    dark = replace(view, image=np.full_like(view.image, 120))
    clear, hazy = (
        stage.draw(replace(dark, softness=PictureQuality(0.3, 0.0, haze, 0.8)), [pawn.posed()])
        for haze in (0.0, 0.2)
    )
    table = hazy.astype(int).std(-1) < 1  # grey, unlike the pawn
    assert clear[table].min() < 80
    assert hazy[table].min() > 100
    assert hazy[table].max() == 120


def test_a_clear_picture_is_drawn_as_without_haze(stage, view, pawn):
    first, second = (
        stage.draw(replace(view, softness=PictureQuality(0.3, 0.0, haze, 0.8)), [pawn.posed()])
        for haze in (0.0, 0.0004)
    )
    assert np.array_equal(first, second)
