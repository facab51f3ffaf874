$scenes << END
3.4674 0.61276
6.24118 0.612759
18.1386 0.612758
42.5526 0.612757

0.243056 0.518429
0.631756 0.518665
1.14548 0.520389
2.81423 0.520282

0.243056 2.06035
0.30787 2.05734
1.02083 2.05914
2.15743 2.05708

1.39255 0.690582
2.33594 0.690477
6.53018 0.690395
15.073 0.690402

1.06929 0.084099
1.15122 0.0860766
1.66822 0.0867812
1.95718 0.0828593

1.06929 0.112714
1.15122 0.116896
1.66822 0.139122
1.95718 0.17818

1.06929 0.0734853
1.15122 0.0754957
1.66822 0.106243
1.95718 0.174763

1.50955 0.224728
1.93084 0.166937
3.20978 0.172409
5.42136 0.219457

1.79822 0.295969
2.22176 0.28117
3.35976 0.330397
5.24719 0.402196

1.70931 0.203094
2.09408 0.196212
3.18227 0.183102
5.02939 0.191396

1.40746 0.354719
2.01524 0.44727
4.08241 1.0908
7.61984 1.53526

1.42909 0.22623
1.87844 0.21693
3.05546 0.215934
5.0366 0.218816

5.16725 0.163158
8.28549 0.161674
19.2311 0.164063
42.4931 0.169741

0.979605 0.332687
1.58483 0.28499
4.00166 0.260441
8.83691 0.256549

0 0.295984
0 0.295984
0 0.295984
0 0.295984

1.05351 28.0318
1.37249 25.6477
2.3809 24.6965
4.17655 23.3892

6.94177 0.314897
10.325 0.302771
22.2382 0.267069
46.1037 0.235276





END
$all << END
1.79704 6.82493 "low"
2.62815 6.24907 "medium"
5.68125 6.02436 "high"
11.6725 5.71566 "ultra"
END
set title "Presets" noenhanced
set grid lt 1 lw 0.7 lc rgb "#cccccc"
set key outside right top vertical Left reverse samplen 2 spacing 1.3
set xlabel "samples of density a pixel and frame, with those towards the sun"
set logscale x
set xrange [0:inf]
set xtics ("1e-06" 1e-06, "1e-05" 1e-05, "0.0001" 0.0001, "0.001" 0.001, "0.01" 0.01, "0.1" 0.1, "1" 1, "10" 10, "100" 100, "1000" 1000, "10000" 10000, "100000" 100000, "1e+06" 1e+06, "1e+07" 1e+07, "1e+08" 1e+08)
set ylabel "relative r.m.s. error of luminance, means over 8 x 8"
set logscale y
set yrange [0.0456756:45.099]
set ytics ("0.05" 0.05, "0.1" 0.1, "0.2" 0.2, "0.5" 0.5, "1" 1, "2" 2, "5" 5, "10" 10, "20" 20)
set terminal svg size 1060,600 font "Sans,13" background "white" noenhanced
set output "tests/report/accuracy/preset_samples.svg"
plot $scenes using 1:2 with linespoints lw 1 pt 7 ps 0.4 lc rgb "#bbbbbb" title "each scene", $all using 1:2 with linespoints lw 3 pt 7 ps 1.2 lc rgb "#0072B2" title "over all scenes", $all using 1:2:3 with labels offset 0,1.1 font ",11" notitle
set terminal pngcairo size 900,500 font "Sans,10" noenhanced
set output "tests/report/accuracy/preset_samples.png"
plot $scenes using 1:2 with linespoints lw 1 pt 7 ps 0.4 lc rgb "#bbbbbb" title "each scene", $all using 1:2 with linespoints lw 3 pt 7 ps 1.2 lc rgb "#0072B2" title "over all scenes", $all using 1:2:3 with labels offset 0,1.1 font ",11" notitle
